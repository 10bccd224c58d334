// SPDX-License-Identifier: MIT
// Measures the skin of a body that is below a plane, or below ground over it, part by part.
#include <algorithm>
#include <cmath>

#include "runtime/src/base/memory.h"
#include "runtime/src/base/status.h"
#include "runtime/src/clusters/set_up.h"
#include "runtime/src/depth/posed_skin.h"
#include "runtime/src/pairs/filter.h"
#include "runtime/src/penetrations/measure.h"
#include "runtime/src/penetrations/penetration_jobs.h"
#include "runtime/src/penetrations/rule.h"
#include "runtime/src/simd/simd.h"

namespace spherechain {
namespace {

constexpr double kUnitError = 1e-3;  // of `up`'s length
constexpr double kAreaError = 0.03;  // if the contour has another area than the skin below, the volume is not known

struct Memory {
  PosedSkin skin;
  double* above = nullptr;  // how far each vertex is above the ground

  std::size_t lay_out(const SkinSizes& sizes, std::uint64_t* words) {
    WordMemory memory(words);
    skin.take(memory, sizes.vertices, sizes.clusters);
    memory.take(above, sizes.vertices);
    return memory.used();
  }
};

std::size_t floor_words(const AssetView& asset) { return Memory().lay_out(asset.skin().sizes, nullptr); }

// A point of a triangle, and how far it is above the ground.
struct Height {
  Double3 p;
  double above;
};

// The skin of a part that lies below the floor.
class Below {
 public:
  Below(const Double3& up, double handedness) : up_(up), handedness_(handedness) {}

  // A triangle that has a corner below.
  void add(const Height (&corners)[3]) {
    Height kept[4];
    int count = 0;
    Double3 cut[2];
    for (int i = 0; i < 3; ++i) {
      const Height &from = corners[i], &to = corners[(i + 1) % 3];
      if (from.above < 0) {
        kept[count++] = from;
      }
      if ((from.above < 0) != (to.above < 0)) {
        const double share = from.above / (from.above - to.above);
        const Double3 at = from.p + share * (to.p - from.p);
        kept[count++] = {at, 0};
        cut[from.above < 0 ? 0 : 1] = at;  // the way along the triangle goes up at the first
      }
    }
    for (int i = 0; i < count; ++i) {
      const Double3& at = kept[i].p;
      low = {std::min(low.x, at.x), std::min(low.y, at.y), std::min(low.z, at.z)};
      high = {std::max(high.x, at.x), std::max(high.y, at.y), std::max(high.z, at.z)};
    }
    for (int i = 1; i + 1 < count; ++i) {
      const Double3 area = 0.5 * handedness_ * cross(kept[i].p - kept[0].p, kept[i + 1].p - kept[0].p);
      area_ = area_ + area;
      total_ += length(area);
      volume_ += dot(area, up_) * (kept[0].above + kept[i].above + kept[i + 1].above) / 3;
    }
    if (corners[0].above >= 0 || corners[1].above >= 0 || corners[2].above >= 0) {
      const Double3 along = handedness_ * (cut[1] - cut[0]);
      if (contour_length == 0) {
        origin_ = cut[0];
      }
      contour_length += length(along);
      enclosed_ = enclosed_ + 0.5 * handedness_ * cross(cut[0] - origin_, cut[1] - origin_);
    }
    ++triangles;
  }

  // Skin that ends below the ground has edges beside the contour: they enclose an area, too.
  bool is_closed() const { return length(area_ - enclosed_) <= kAreaError * total_ && volume_ >= 0; }
  double volume() const { return volume_; }
  Double3 centre() const { return 0.5 * (low + high); }

  std::size_t triangles = 0;
  Double3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  double contour_length = 0;

 private:
  Double3 up_, area_{}, enclosed_{}, origin_{};
  double handedness_, total_ = 0, volume_ = 0;
};

class Measurer {
 public:
  Measurer(const AssetView& asset, const Surface& surface, const FloorJob& job)
      : asset_(asset), surface_(surface), job_(job), up_(to_double(job.up)) {
    memory_.skin.surface = &surface;
    memory_.lay_out(asset.skin().sizes, job.scratch);
  }

  Status run(Target resolved, FloorJob& job) {
    memory_.skin.fill(job.body.pose, resolved);
    find_heights();
    job.penetration_count = 0;
    for (std::size_t part = 0; part < asset_.part_count(); ++part) {
      const std::uint64_t* const ignored = job.body.ignored_parts;
      if (ignored != nullptr && (ignored[part / 64] >> part % 64 & 1) != 0) {
        continue;
      }
      Penetration found{};
      if (!measure(part, found) || (job.classes != 0 && (job.classes >> found.kind & 1) == 0)) {
        continue;
      }
      if (job.penetration_capacity > 0) {
        keep_worst({job.penetrations, job.penetration_capacity}, found, job.penetration_count);
      }
      ++job.penetration_count;
    }
    if (job.penetration_capacity == 0 || job.penetration_count <= job.penetration_capacity) {
      return done();
    }
    std::sort(job.penetrations, job.penetrations + job.penetration_capacity,
              [](const Penetration& l, const Penetration& r) { return l.part < r.part; });
    return refuse(SC_OVERFLOW, SC_FIELD_PENETRATIONS);
  }

 private:
  void find_heights() {
    for (std::size_t v = 0; v < surface_.source_vertices.size; ++v) {
      const float* const p = memory_.skin.positions + 3 * v;
      double above = dot(up_, Double3{double{p[0]}, double{p[1]}, double{p[2]}}) - double{job_.height};
      if (job_.terrain != nullptr) {
        above -= double{job_.terrain(job_.user, {p[0], p[1], p[2]})};
      }
      memory_.above[v] = std::isfinite(above) ? above : 0;  // of what is not finite nothing is below
    }
  }

  bool measure(std::size_t part, Penetration& out) const {
    Below below(up_, memory_.skin.handedness);
    double deepest = 0;
    for (std::size_t i = surface_.first_of_part[part]; i < surface_.first_of_part[part + 1]; ++i) {
      const TriangleRun& run = surface_.part_runs[i];
      for (std::uint32_t t = run.first; t < run.first + run.count; ++t) {
        const std::uint32_t* const v = surface_.triangle_vertices.data + 3 * std::size_t{t};
        const double least = std::min({memory_.above[v[0]], memory_.above[v[1]], memory_.above[v[2]]});
        if (!(least < 0)) {
          continue;
        }
        const Corners corners = memory_.skin.corners(t);
        below.add({{corners.p[0], memory_.above[v[0]]},
                   {corners.p[1], memory_.above[v[1]]},
                   {corners.p[2], memory_.above[v[2]]}});
        if (least < deepest) {
          deepest = least;
          const std::size_t k = memory_.above[v[0]] == least ? 0 : memory_.above[v[1]] == least ? 1 : 2;
          out.deepest = {to_float(corners.p[k]), surface_.triangles[t], {}};
          out.deepest.weights[k] = 1;
        }
      }
    }
    if (below.triangles == 0) {
      return false;
    }
    const AssetInfo info = asset_.info();
    const double scale = scale_of(asset_, job_.body.pose), height = scale * double{info.height};
    const double metre = scale / double{info.metres_per_unit};
    const Rule limits = job_.rule == nullptr ? sc_default_rule() : *job_.rule;
    out.part = static_cast<std::uint32_t>(part);
    out.other = SC_FLOOR;
    out.joint = static_cast<std::uint32_t>(asset_.part(part).bone);
    out.distance = out.measures.depth = std::max(static_cast<float>(-deepest), static_cast<float>(1e-7 * height));
    out.measures.volume = below.is_closed() ? static_cast<float>(below.volume()) : -1;
    out.measures.contour_length = static_cast<float>(below.contour_length);
    out.measures.visible = 1;
    out.measures.rest_distance = HUGE_VALF;
    out.measures.thickness = out.measures.extent = -1;
    out.measures.height = static_cast<float>(height);
    out.measures.metre = static_cast<float>(metre);
    out.measures.relation = SC_RELATION_TWO_BODIES;
    const double beyond = -deepest - touch_depth_of(limits, metre, height);
    out.kind = beyond < 0 ? SC_CLASS_TOUCH : SC_CLASS_PENETRATION;
    out.fault_depth = static_cast<float>(std::max(beyond, 0.0));
    out.direction = job_.up;
    out.centre = to_float(below.centre());
    out.low = to_float(below.low);
    out.high = to_float(below.high);
    const Vec3& p = out.deepest.position;
    out.deepest_other = {
        {p.x + out.distance * job_.up.x, p.y + out.distance * job_.up.y, p.z + out.distance * job_.up.z}, SC_FLOOR, {}};
    return true;
  }

  const AssetView& asset_;
  const Surface& surface_;
  const FloorJob& job_;
  Double3 up_;
  Memory memory_;
};

Status check(const FloorJob& job, Target& resolved, Surface& surface) {
  const Status statuses[] = {check_skin(job.body.asset, job.body.pose, job.body.skin_table, surface),
                             check_list(job.body.ignored_parts, 0, SC_FIELD_IGNORED_PARTS),
                             check_list(job.scratch, 1, SC_FIELD_SCRATCH),
                             check_list(job.penetrations, job.penetration_capacity, SC_FIELD_PENETRATIONS)};
  for (const Status& status : statuses) {
    if (status != SC_OK) {
      return status;
    }
  }
  if (job.scratch_words < floor_scratch_words(job.body.asset)) {
    return refuse(SC_TOO_SMALL, SC_FIELD_SCRATCH);
  }
  if (!(std::abs(length(to_double(job.up)) - 1) <= kUnitError) || !std::isfinite(job.height)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_FLOOR);
  }
  if (const Status rule = check_rule(job.rule); rule != SC_OK) {
    return rule;
  }
  if (!resolve_target(job.target, resolved)) {
    return refuse(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET);
  }
  const BodyRanges body(job.body);
  return any_shared({range_of(Span<Penetration>{job.penetrations, job.penetration_capacity}),
                     range_of(Span<std::uint64_t>{job.scratch, floor_scratch_words(job.body.asset)})},
                    {body.vertices, body.bones, body.morph_weights, body.skin_table, body.ignored_parts})
             ? refuse(SC_ALIASED, SC_FIELD_OUTPUT)
             : done();
}

}  // namespace
std::size_t floor_scratch_words(const Asset* asset) noexcept {
  return asset == nullptr || !has_skin(view_of(*asset)) ? 0 : floor_words(view_of(*asset));
}

Status FloorJob::run() noexcept {
  Target resolved{};
  Surface surface;
  const Status status = check(*this, resolved, surface);
  return status == SC_OK ? Measurer(view_of(*this->body.asset), surface, *this).run(resolved, *this) : status;
}

}  // namespace spherechain
