// SPDX-License-Identifier: MIT
// The boxes of a sweep. keep() selects the triangles that can meet at all, by the boxes of their clusters. In each
// view, see_boxes() selects their blocks of 16 that can, and make_boxes() makes boxes of single triangles on demand.
#include <algorithm>
#include <cfloat>
#include <cmath>

#include "runtime/src/depth/sweep.h"

namespace spherechain {
namespace {

constexpr float kRounding = 1e-5F;  // relative; many times the rounding error of a sum of three products

}  // namespace

void Sweep::Boxes::take(WordMemory& memory, std::size_t capacity) {
  const std::size_t blocks = (capacity + kBlock - 1) / kBlock;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    memory.take(low[axis], blocks * kBlock);
    memory.take(high[axis], blocks * kBlock);
    memory.take(block_low[axis], blocks + kBlock);
    memory.take(block_high[axis], blocks + kBlock);
    memory.take(middle[axis], blocks);
    memory.take(half[axis], blocks);
  }
  memory.take(sphere, blocks);
  memory.take(is_live, blocks);
  memory.take(block, blocks);
  memory.take(has_boxes, blocks);
  memory.take(triangle, capacity);
  memory.take(corners, 3 * capacity);
}

// Sets the interval of each block along u, v and d. It encloses those of the block's triangles.
void Sweep::Boxes::view_blocks(const View& view) {
  block_count = (count + kBlock - 1) / kBlock;
  const Double3* const axes[3] = {&view.u, &view.v, &view.d};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3 a = to_float(*axes[axis]);
    for (std::size_t i = 0; i < block_count; ++i) {
      const float at = a.x * middle[0][i] + (a.y * middle[1][i] + a.z * middle[2][i]);
      const float reach = std::abs(a.x) * half[0][i] + (std::abs(a.y) * half[1][i] + std::abs(a.z) * half[2][i]);
      block_low[axis][i] = at - reach;
      block_high[axis][i] = at + reach;
    }
  }
  for (std::size_t i = 0; i < block_count; ++i) {
    block[i] = static_cast<std::uint32_t>(i);
  }
}

// Keeps the live blocks that reach into a box, and those that are not finite.
void Sweep::Boxes::keep_blocks(const float (&least)[3], const float (&most)[3]) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < block_count; ++i) {
    bool is_outside = is_live[block[i]] == 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      is_outside = is_outside || block_low[axis][i] > most[axis] || block_high[axis][i] < least[axis];
    }
    if (!is_outside) {
      block[kept] = block[i];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        block_low[axis][kept] = block_low[axis][i];
        block_high[axis][kept] = block_high[axis][i];
      }
      ++kept;
    }
  }
  block_count = kept;
}

void Sweep::Boxes::close() {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::fill(block_low[axis] + block_count, block_low[axis] + block_count + kBlock, FLT_MAX);
    std::fill(block_high[axis] + block_count, block_high[axis] + block_count + kBlock, -FLT_MAX);
  }
  std::fill(has_boxes, has_boxes + block_count, 0U);
}

bool Sweep::Boxes::make_boxes(std::size_t i, const float* const (&seen)[3]) {
  if (has_boxes[i] != 0) {
    return false;
  }
  has_boxes[i] = 1;
  const std::size_t first = kBlock * block[i], end = std::min(first + kBlock, count);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float* const at = seen[axis];
    float least = FLT_MAX, most = -FLT_MAX;
    for (std::size_t t = first; t < end; ++t) {
      const float p = at[corners[3 * t]], q = at[corners[3 * t + 1]], r = at[corners[3 * t + 2]];
      low[axis][t] = std::min(std::min(p, q), r);
      high[axis][t] = std::max(std::max(p, q), r);
      least = std::min(least, low[axis][t]);
      most = std::max(most, high[axis][t]);
    }
    std::fill(low[axis] + end, low[axis] + first + kBlock, FLT_MAX);
    std::fill(high[axis] + end, high[axis] + first + kBlock, -FLT_MAX);
    block_low[axis][i] = least;
    block_high[axis][i] = most;
  }
  return true;
}

void Sweep::keep(const Reach& reach) {
  for (std::size_t i = 0; i < vertices_.count; ++i) {
    vertices_.place[vertices_.vertex[i]] = kNoPlace;
  }
  vertices_.count = 0;
  keep_runs(side_a(), side_b(), reach, a_);
  keep_runs(side_b(), side_a(), {reach.down, reach.up}, b_);
  list_vertices(side_a(), a_);
  list_vertices(side_b(), b_);
}

// Widens the boxes of the blocks that a run comes to lie in by the box of the run's cluster.
void Sweep::widen_blocks(const PosedSkin& skin, const TriangleRun& run, bool is_live, Boxes& out) const {
  const double origin[3] = {vertices_.origin.x, vertices_.origin.y, vertices_.origin.z};
  const std::uint32_t sphere = skin.surface->clusters[run.cluster].sphere;
  for (std::size_t i = out.count / kBlock; kBlock * i < out.count + run.count; ++i) {
    const bool is_first = kBlock * i >= out.count;
    out.sphere[i] = is_first || out.sphere[i] == sphere ? sphere : kNoPlace;
    out.is_live[i] = is_live || (!is_first && out.is_live[i] != 0) ? 1 : 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      auto low = static_cast<float>(double{skin.low[axis][run.cluster]} - origin[axis]);
      auto high = static_cast<float>(double{skin.high[axis][run.cluster]} - origin[axis]);
      if (!is_first) {
        low = std::min(low, out.middle[axis][i] - out.half[axis][i]);
        high = std::max(high, out.middle[axis][i] + out.half[axis][i]);
      }
      out.middle[axis][i] = 0.5F * (low + high);
      out.half[axis][i] = 0.5F * (high - low) + kRounding * std::max(std::abs(low), std::abs(high));
    }
  }
}

// Keeps the runs whose cluster's box meets a box of the other side that is `reach` wider up and down along each axis.
void Sweep::keep_runs(const Side& side, const Side& other, const Reach& reach, Boxes& out) {
  const double up[3] = {reach.up.x + gap_, reach.up.y + gap_, reach.up.z + gap_};
  const double down[3] = {reach.down.x + gap_, reach.down.y + gap_, reach.down.z + gap_};
  double highest[3], lowest[3];  // of all runs of the other side
  for (std::size_t axis = 0; axis < 3; ++axis) {
    highest[axis] = -HUGE_VAL;
    lowest[axis] = HUGE_VAL;
    for (const TriangleRun& from : other.runs) {
      highest[axis] = std::max(highest[axis], double{other.skin.high[axis][from.cluster]});
      lowest[axis] = std::min(lowest[axis], double{other.skin.low[axis][from.cluster]});
    }
  }
  out.count = 0;
  for (const TriangleRun& run : side.runs) {
    const auto is_near = [&](const auto& high, const auto& low) {
      bool near = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        near = near && double{side.skin.low[axis][run.cluster]} <= high(axis) + up[axis] &&
               double{side.skin.high[axis][run.cluster]} >= low(axis) - down[axis];
      }
      return near;
    };
    const auto is_near_run = [&](const TriangleRun& from) {
      return is_near([&](std::size_t axis) { return double{other.skin.high[axis][from.cluster]}; },
                     [&](std::size_t axis) { return double{other.skin.low[axis][from.cluster]}; });
    };
    if (rule_.leaves_out(run.cluster) ||
        !is_near([&](std::size_t axis) { return highest[axis]; }, [&](std::size_t axis) { return lowest[axis]; })) {
      continue;
    }
    const std::uint32_t sphere = side.skin.surface->clusters[run.cluster].sphere;
    const auto is_partner = [&](const TriangleRun& from) {
      return is_near_run(from) && may_count(sphere, other.skin.surface->clusters[from.cluster].sphere);
    };
    const TriangleRun* const near = std::find_if(other.runs.begin(), other.runs.end(), is_near_run);
    if (near != other.runs.end()) {
      widen_blocks(side.skin, run, std::any_of(near, other.runs.end(), is_partner), out);
      for (std::uint32_t i = 0; i < run.count; ++i) {
        out.triangle[out.count++] = run.first + i;
      }
    }
  }
}

// Numbers the vertices that the triangles of live blocks use, so that they lie near each other: every view reads them.
void Sweep::list_vertices(const Side& side, Boxes& boxes) {
  for (std::size_t i = 0; i < boxes.count; ++i) {
    if (boxes.is_live[i / kBlock] == 0) {
      continue;
    }
    const std::uint32_t* const corners = side.skin.surface->triangle_vertices.data + 3 * std::size_t{boxes.triangle[i]};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = side.first_vertex + corners[k];
      std::uint32_t& place = vertices_.place[vertex];
      if (place == kNoPlace) {
        place = static_cast<std::uint32_t>(vertices_.count);
        vertices_.vertex[vertices_.count] = vertex;
        const float* const p = side.skin.positions + 3 * std::size_t{corners[k]};
        vertices_.at[0][vertices_.count] = static_cast<float>(double{p[0]} - vertices_.origin.x);
        vertices_.at[1][vertices_.count] = static_cast<float>(double{p[1]} - vertices_.origin.y);
        vertices_.at[2][vertices_.count] = static_cast<float>(double{p[2]} - vertices_.origin.z);
        ++vertices_.count;
      }
      boxes.corners[3 * i + k] = place;
    }
  }
}

// Boxes need no more than single precision: their triangles are compared in double precision.
void Sweep::see_boxes(double depth) {
  a_.view_blocks(view_);
  b_.view_blocks(view_);
  // Each side keeps the blocks that reach into the box around the other side; that box is smaller the second time. A
  // pair blocks a way longer than `depth` only if b must rise by more than that to pass a.
  const float rise = static_cast<float>(depth) * (1 - kRounding);
  for (int turn = 0; turn < 2; ++turn) {
    for (Boxes* const side : {&a_, &b_}) {
      const Boxes& other = side == &a_ ? b_ : a_;
      float least[3], most[3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        least[axis] = FLT_MAX;
        most[axis] = -FLT_MAX;
        for (std::size_t i = 0; i < other.block_count; ++i) {
          least[axis] = std::min(least[axis], other.block_low[axis][i]);
          most[axis] = std::max(most[axis], other.block_high[axis][i]);
        }
      }
      if (side == &a_) {
        least[2] += rise;
        most[2] = FLT_MAX;
      } else {
        least[2] = -FLT_MAX;
        most[2] -= rise;
      }
      side->keep_blocks(least, most);
    }
  }
  const float *const x = vertices_.at[0], *const y = vertices_.at[1], *const z = vertices_.at[2];
  const Double3* const axes[3] = {&view_.u, &view_.v, &view_.d};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3 a = to_float(*axes[axis]);
    float* const out = vertices_.seen[axis];
    for (std::size_t i = 0; i < vertices_.count; ++i) {
      out[i] = a.x * x[i] + (a.y * y[i] + a.z * z[i]);
    }
  }
  a_.close();
  b_.close();
}

}  // namespace spherechain
