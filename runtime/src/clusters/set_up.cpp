// SPDX-License-Identifier: MIT
#include "runtime/src/clusters/set_up.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>

#include "runtime/src/base/arithmetic.h"
#include "runtime/src/base/pair_bits.h"
#include "runtime/src/base/status.h"

namespace spherechain {

void lay_out(const AssetView& asset, WordMemory& memory, PosedClusters& posed) {
  const SkinSizes& sizes = asset.skin().sizes;
  posed.sphere_count = asset.spheres().size;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    memory.take(posed.spheres.low[axis], posed.sphere_count);
    memory.take(posed.spheres.high[axis], posed.sphere_count);
    memory.take(posed.clusters.low[axis], sizes.clusters);
    memory.take(posed.clusters.high[axis], sizes.clusters);
  }
  memory.take(posed.is_loaded, sizes.clusters);
  memory.take(posed.is_bounded, posed.sphere_count);
  memory.take(posed.spans, 2 * kSpanLanes * sizes.clusters);
  memory.take(posed.slots, 3 * sizes.slots + 3 * (kSlotLanes * sizes.clusters + kContactPadding));
  if (asset.bone_count() > 0) {
    memory.take(posed.bone_sizes, asset.bone_count());
    for (float*& column : posed.ball_columns) {
      memory.take(column, sizes.clusters);
    }
    memory.take(posed.is_group_bounded, asset.skin().bounds_term_counts.size);
    memory.take(posed.columns, kColumnFloats * asset.bone_count());
    memory.take(posed.hulls, 3 * sizes.hull_points);
    memory.take(posed.hull_margins, posed.sphere_count);
  }
}

namespace {

BoneSize bone_size(const BoneMatrices& bones, std::size_t bone) {
  const float* m = bones.data + bone * bones.stride;
  float gram[3][3];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) {
      const float* p = m + i * bones.column;
      const float* q = m + j * bones.column;
      gram[i][j] = gram[j][i] =
          std::abs((p[0] * q[0] + p[bones.row] * q[bones.row]) + p[2 * bones.row] * q[2 * bones.row]);
    }
  }
  float most = 0, all = 0;
  for (const auto& row : gram) {
    const float sum = (row[0] + row[1]) + row[2];
    most = std::max(most, sum);
    all += sum;
  }
  if (std::isnan(all)) {  // products overflowed, with either sign: the maximum lost it
    most = std::numeric_limits<float>::infinity();
  }
  const float* t = m + 3 * bones.column;
  return {std::sqrt(most), std::max({std::abs(t[0]), std::abs(t[bones.row]), std::abs(t[2 * bones.row])})};
}

// Prepares bounds by bones: marks every group as not bounded, and stores each bone's size and its matrix by columns.
void prepare_bounds(const AssetView& asset, PosedClusters& posed) {
  const BoneMatrices& bones = posed.skin.bones;
  std::fill_n(posed.is_group_bounded, asset.skin().bounds_term_counts.size, std::uint8_t{0});
  for (std::size_t bone = 0; bone < asset.bone_count(); ++bone) {
    posed.bone_sizes[bone] = bone_size(bones, bone);
    const float* const matrix = bones.data + bone * bones.stride;
    float* const columns = posed.columns + kColumnFloats * bone;
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t i = 0; i < 3; ++i) {
        columns[4 * j + i] = matrix[i * bones.row + j * bones.column];
      }
      columns[4 * j + 3] = 0;
    }
  }
}

}  // namespace

bool has_skin(const AssetView& asset) { return asset.is_open() && asset.skin().sizes.clusters > 0; }

// A vertex is a mean, by its weights, of where its bones would move it; so the skin is in a box around the bones'
// boxes. Roundings are less than 64 + 16 N units of the greatest coordinate that goes into one: see cluster_bounds.h.
Bounds3 bound_bones(const AssetView& asset, const Surface& surface, const Pose& pose, float* boxes) {
  constexpr float kUnit = 1.0F / 16777216.0F;
  const BoneMatrices bones = matrices_of(pose);
  float morphed = 0;
  for (std::size_t i = 0; pose.morph_weights != nullptr && i < surface.morph_reach.size; ++i) {
    morphed += std::abs(pose.morph_weights[i]) * surface.morph_reach[i];
  }
  Bounds3 all{{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
  float most = 0;
  for (std::size_t bone = 0; bone < surface.bone_boxes.size; ++bone) {
    const BoneBox& rest = surface.bone_boxes[bone];
    const float center[3] = {rest.center.x, rest.center.y, rest.center.z};
    const float half[3] = {rest.half.x + morphed, rest.half.y + morphed, rest.half.z + morphed};
    const bool moves = rest.half.x >= 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const float* const row = bones.data + bone * bones.stride + i * bones.row;
      float at = row[3 * bones.column], reach = 0, size = std::abs(at);
      for (std::size_t j = 0; j < 3; ++j) {
        const float m = row[j * bones.column];
        at += m * center[j];
        reach += std::abs(m) * half[j];
        size += std::abs(m) * (std::abs(center[j]) + half[j]);
      }
      float low = moves ? at - reach : FLT_MAX, high = moves ? at + reach : -FLT_MAX;
      if (moves && !(size < 0x1p60F)) {  // what is not a number, or overflows, bounds nothing
        low = -FLT_MAX;
        high = FLT_MAX;
      } else if (moves) {
        most = std::max(most, size);
      }
      all.low[i] = std::min(all.low[i], low);
      all.high[i] = std::max(all.high[i], high);
      if (boxes != nullptr) {
        boxes[6 * bone + i] = low;
        boxes[6 * bone + 3 + i] = high;
      }
    }
  }
  const float margin = kUnit * most * (64.0F + 16.0F * static_cast<float>(asset.bone_count())) + 0x1p-60F;
  const auto widen = [&](float* low, float* high) {
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::max(low[i] - margin, -FLT_MAX);
      high[i] = std::min(high[i] + margin, FLT_MAX);
    }
  };
  widen(all.low, all.high);
  for (std::size_t bone = 0; boxes != nullptr && bone < surface.bone_boxes.size; ++bone) {
    widen(boxes + 6 * bone, boxes + 6 * bone + 3);
  }
  return all;
}

// Bounds the finite vertices. Other vertices intersect nothing and are skipped.
Bounds3 bound_vertices(const Surface& surface, const Pose& pose) {
  Bounds3 all{{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
  const std::size_t stride = vertex_stride(pose);
  for (const std::uint32_t vertex : surface.source_vertices) {
    const float* const p = vertex_at(pose.vertices, vertex, stride);
    if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])) {
      for (std::size_t i = 0; i < 3; ++i) {
        all.low[i] = std::min(all.low[i], p[i]);
        all.high[i] = std::max(all.high[i], p[i]);
      }
    }
  }
  return all;
}

void bound_bones_of_two(const AssetView& asset_a, PosedClusters& a, const AssetView& asset_b, PosedClusters& b,
                        const Pose& pose_a, const Pose& pose_b, WordMemory& memory) {
  float *of_a = nullptr, *of_b = nullptr;
  memory.take(of_a, 6 * asset_a.bone_count());
  memory.take(of_b, 6 * asset_b.bone_count());
  if (a.has_hulls && b.has_hulls && of_a != nullptr) {
    bound_bones(asset_a, *a.surface, pose_a, of_a);
    bound_bones(asset_b, *b.surface, pose_b, of_b);
    a.bone_boxes = of_a;
    b.bone_boxes = of_b;
  }
}

BodyRanges::BodyRanges(const JobBody& body)
    : vertices(range_of_vertices(view_of(*body.asset), body.pose)),
      bones(range_of_bones(view_of(*body.asset), body.pose)),
      morph_weights(range_of_morph_weights(view_of(*body.asset), body.pose)),
      skin_table(range_of(Span<const std::uint64_t>{body.skin_table, skin_table_words(view_of(*body.asset))})),
      ignored_parts(range_of(Span<const std::uint64_t>{body.ignored_parts, sc_part_words(body.asset)})) {}

Status check_asset(const Asset* asset) {
  return asset == nullptr             ? refuse(SC_NULL, SC_FIELD_ASSET)
         : !view_of(*asset).is_open() ? refuse(SC_NOT_OPEN, SC_FIELD_ASSET)
         : !has_skin(view_of(*asset)) ? refuse(SC_NOT_IN_ASSET, SC_FIELD_ASSET)
                                      : done();
}

Status check_skin(const Asset* asset, const Pose& pose, const std::uint64_t* skin_table, Surface& surface) {
  Status status = check_asset(asset);
  if (status == SC_OK) {
    status = check_skin_pose(view_of(*asset), pose);
  }
  return status == SC_OK ? read_skin_table(view_of(*asset), skin_table, surface) : status;
}

void set_pose(const AssetView& asset, const Surface& surface, const Pose& pose, const Filter* filter,
              PosedClusters& posed) {
  posed.surface = &surface;
  posed.has_sphere_boxes = false;
  posed.first_cluster = surface.first_clusters.data;
  posed.positions = pose.vertices;
  posed.stride = vertex_stride(pose) / sizeof(float);
  std::fill_n(posed.is_loaded, surface.clusters.size, std::uint8_t{0});
  std::fill_n(posed.is_bounded, posed.sphere_count, std::uint8_t{0});
  posed.ignored = asset.ignored();
  if (filter != nullptr) {
    posed.ignored = {filter->ignored, filter->ignored_words};
  }
  if (pose.bones != nullptr) {
    const float* const weights = pose.morph_weights;
    const bool morphs = weights != nullptr && surface.bounds_first_morphs.size > 0 &&
                        std::any_of(weights, weights + asset.morph_count(), [](float w) { return w != 0.0F; });
    posed.skin = {&surface, matrices_of(pose), morphs ? weights : nullptr};
    posed.has_balls = true;
    posed.has_hulls = !morphs;
    prepare_bounds(asset, posed);
  }
}

PosedClusters posed_clusters_of(const AssetView& asset, const Surface& surface, const Pose& pose, const Filter* filter,
                                WordMemory& memory) {
  PosedClusters posed;
  lay_out(asset, memory, posed);
  set_pose(asset, surface, pose, filter, posed);
  return posed;
}

}  // namespace spherechain
