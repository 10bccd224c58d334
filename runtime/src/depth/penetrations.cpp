// SPDX-License-Identifier: MIT
// From triangles that meet to depth, direction, volume and class of each two body parts.
#include "spherechain/penetrations.h"

#include <algorithm>

#include "asset/status.h"
#include "depth/visibility.h"
#include "depth/way_out.h"
#include "pairs/filter.h"
#include "simd/simd.h"

namespace spherechain {
namespace {

// Lengths are parts of the character's height, but those in metres.
constexpr double kTouchMetres = 0.005, kTouchMin = 0.0032, kTouchMax = 0.011;
constexpr double kTouchFlat = 3;                        // times as deep, where the sides lie flat on each other
constexpr double kTouchSide = 3;                        // times: the side of a square that is too small to be seen
constexpr double kHidden = 0.3;                         // less of the contour is visible: it is hidden
constexpr double kGapMetres = 0.0006, kGapMax = 0.001;  // shorter free places on the way are none
constexpr double kFoldDistance = 0.11;                  // of two spots at rest, to be a fold
constexpr double kNeighbourDistance = 0.055;            // likewise, whatever the parts are
constexpr double kShellDistance = 0.035;                // likewise, to be layers of the same place
constexpr double kDeepFold = 0.045, kFoldFacing = 0.2;
constexpr double kNear = 0.006;
constexpr double kClearance = 3e-4;
constexpr double kAreaError = 0.03;  // if the contour has another area than the skin inside, the volume is not known

struct Memory {
  PosedSkin skin;
  ContourScratch contour;
  Visibility visibility{skin};
  Span<std::uint64_t> keys;
  Span<Segment3> segments;
  Span<TriangleRun> side_a, side_b;  // of a part that meets itself

  std::size_t lay_out(const AssetView& asset, std::size_t contact_count, std::uint64_t* words, Sweep& sweep) {
    const SkinSizes& sizes = asset.skin().sizes;
    WordMemory memory(words);
    skin.take(memory, sizes.vertices, sizes.clusters);
    contour.take(memory, contact_count, sizes.triangles);
    memory.take(keys, contact_count);
    memory.take(segments, contact_count);
    memory.take(side_a, contact_count);
    memory.take(side_b, contact_count);
    sweep.take(memory, sizes.triangles, sizes.vertices);
    return memory.used();
  }
};

class Measurer {
 public:
  Measurer(const AssetView& asset, const Surface& surface, const PenetrationJob& job)
      : asset_(asset),
        surface_(surface),
        job_(job),
        rule_{&surface, asset.ignored(), {}, job.scope != SC_SCOPE_NEIGHBOURS, job.scope != SC_SCOPE_APART},
        info_(asset.info()),
        metre_(1 / double{info_.metres_per_unit}),
        height_(info_.height),
        sweep_(memory_.skin, rule_, std::min(kGapMetres * metre_, kGapMax * height_)) {
    if (job.filter != nullptr) {
      rule_.ignored = {job.filter->ignored, job.filter->ignored_words};
      rule_.disabled = {job.filter->disabled, job.filter->disabled_words};
    }
    memory_.skin.surface = &surface;
    memory_.lay_out(asset, job.contact_count, job.scratch, sweep_);
  }

  Status run(Target resolved, PenetrationJob& job) {
    job.penetration_count = 0;
    if (job.contact_count == 0) {
      return done();
    }
    memory_.contour.clear(surface_.triangles.size);
    sweep_.clear(surface_.source_vertices.size);
    if (job.quick != 0) {
      std::uint64_t parts[4] = {};
      for (std::size_t i = 0; i < job.contact_count; ++i) {
        for (const std::size_t part : {part_of(job.contacts[i].triangle_a), part_of(job.contacts[i].triangle_b)}) {
          parts[part / 64] |= std::uint64_t{1} << part % 64;
        }
      }
      memory_.skin.fill(job.pose, resolved, parts);
    } else {
      memory_.skin.fill(job.pose, resolved);
    }
    const std::size_t count = sort_segments();
    for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
      while (end < count && memory_.keys[end] >> 32 == memory_.keys[begin] >> 32) {
        ++end;
      }
      if (job.penetration_count < job.penetration_capacity) {
        job.penetrations[job.penetration_count] = measure({memory_.segments.data + begin, end - begin});
      }
      ++job.penetration_count;
    }
    return job.penetration_capacity > 0 && job.penetration_count > job.penetration_capacity
               ? refuse(SC_OVERFLOW, SC_FIELD_PENETRATIONS)
               : done();
  }

 private:
  // Of a contact, part a's triangle first.
  Segment3 segment_of(const TriangleContact& contact) const {
    Segment3 out{};
    out.a = surface_.place_of_source[contact.triangle_a];
    out.b = surface_.place_of_source[contact.triangle_b];
    if (surface_.parts[out.a] > surface_.parts[out.b]) {
      std::swap(out.a, out.b);
    }
    out.normal_a = memory_.skin.handedness * normal_of(memory_.skin.corners(out.a));
    out.normal_b = memory_.skin.handedness * normal_of(memory_.skin.corners(out.b));
    out.normal_a = normalize(out.normal_a) ? out.normal_a : Double3{0, 0, 0};
    out.normal_b = normalize(out.normal_b) ? out.normal_b : Double3{0, 0, 0};
    out.from = to_double(contact.from);
    out.to = to_double(contact.to);
    if (dot(cross(out.normal_a, out.normal_b), out.to - out.from) < 0) {
      std::swap(out.from, out.to);
    }
    out.length = length(out.to - out.from);
    if (!std::isfinite(out.length)) {
      out.from = out.to = memory_.skin.corners(out.a).p[0];
      out.length = 0;
    }
    return out;
  }

  std::size_t part_of(std::uint32_t source_triangle) const {
    return surface_.parts[surface_.place_of_source[source_triangle]];
  }

  // By pairs of parts, in these as they were given.
  std::size_t sort_segments() {
    std::size_t count = 0;
    for (std::size_t i = 0; i < job_.contact_count; ++i) {
      const std::uint64_t p = part_of(job_.contacts[i].triangle_a), q = part_of(job_.contacts[i].triangle_b);
      memory_.keys[count++] = std::min(p, q) << 48 | std::max(p, q) << 32 | i;
    }
    std::sort(memory_.keys.begin(), memory_.keys.begin() + count,
              [](std::uint64_t l, std::uint64_t r) { return l < r; });
    for (std::size_t i = 0; i < count; ++i) {
      memory_.segments[i] = segment_of(job_.contacts[memory_.keys[i] & 0xFFFFFFFF]);
    }
    return count;
  }

  Span<const TriangleRun> runs_of(std::size_t part) const {
    const std::uint32_t first = surface_.first_of_part[part];
    return {surface_.part_runs.data + first, surface_.first_of_part[part + 1] - first};
  }

  // Triangles each once.
  Span<const TriangleRun> unique(Span<TriangleRun> runs) const {
    const auto first = [](const TriangleRun& run) { return run.first; };
    std::sort(runs.begin(), runs.end(), [&](const auto& l, const auto& r) { return first(l) < first(r); });
    const auto end =
        std::unique(runs.begin(), runs.end(), [&](const auto& l, const auto& r) { return first(l) == first(r); });
    for (TriangleRun* run = runs.begin(); run != end; ++run) {
      const auto after = std::upper_bound(surface_.clusters.begin(), surface_.clusters.end(), run->first,
                                          [](std::uint32_t t, const Cluster& c) { return t < c.first_triangle; });
      run->cluster = static_cast<std::uint32_t>(after - surface_.clusters.begin() - 1);
    }
    return {runs.data, static_cast<std::size_t>(end - runs.begin())};
  }

  void set_sides(const Contour& contour, std::size_t part_a, std::size_t part_b) {
    if (part_a != part_b) {
      sweep_.set_sides(runs_of(part_a), runs_of(part_b), contour.center);
      return;
    }
    const std::size_t count = contour.segments.size;
    for (std::size_t i = 0; i < count; ++i) {
      memory_.side_a[i] = {0, contour.segments[i].a, 1};
      memory_.side_b[i] = {0, contour.segments[i].b, 1};
    }
    sweep_.set_sides(unique({memory_.side_a.data, count}), unique({memory_.side_b.data, count}), contour.center);
  }

  Penetration measure(Span<Segment3> segments) {
    const std::size_t part_a = surface_.parts[segments[0].a], part_b = surface_.parts[segments[0].b];
    const Contour contour = contour_of(memory_.skin, segments, height_, memory_.contour);
    set_sides(contour, part_a, part_b);
    const Double3 previous = previous_direction(part_a, part_b);
    const bool has_previous = dot(previous, previous) > 0 && std::isfinite(dot(previous, previous));
    const bool folds = is_fold(contour, part_a, part_b);
    const Exit exit =
        find_exit(sweep_, contour,
                  {job_.quick != 0, memory_.skin.handedness, kNear * height_, folds ? kDeepFold * height_ : 0,
                   has_previous && job_.quick == 0 ? &previous : nullptr});
    Penetration out{};
    out.part_a = static_cast<std::uint32_t>(part_a);
    out.part_b = static_cast<std::uint32_t>(part_b);
    // Triangles that just touch are clear of each other after any move: the least there is.
    out.depth = std::max(static_cast<float>(exit.way.depth), static_cast<float>(1e-7 * height_));
    out.direction = to_float(exit.direction);
    out.contour_length = static_cast<float>(contour.length);
    out.deepest_a = point_of(exit.way.a, exit.way.point_a, segments[0].a);
    out.deepest_b = point_of(exit.way.b, exit.way.point_b, segments[0].b);
    // All of the line is in sight, as far as its own sides do not hide it.
    Seen seen{1, contour.length * std::sqrt(std::max(0.0, 1 - contour.facing) / 2)};
    if (job_.quick == 0) {
      if (contour.is_closed && part_a != part_b) {
        sweep_.keep_on_way(exit.direction, exit.way.depth);
        const Volume volume = sweep_.volume(exit.direction, exit.way.depth);
        const double area = dot(contour.area, exit.direction);
        out.is_closed = std::abs(volume.area - area) <= kAreaError * volume.total && volume.volume >= 0 ? 1 : 0;
        out.volume = out.is_closed != 0 ? static_cast<float>(volume.volume) : 0;
      }
      Double3 axes[3];
      axes_of(contour, exit.direction, axes);
      seen = memory_.visibility.look(contour, axes, kClearance * height_);
    }
    out.visible = static_cast<float>(seen.share);
    out.kind = class_of(contour, out, seen.length);
    return out;
  }

  SkinPoint point_of(std::uint32_t triangle, const Double3& at, std::uint32_t otherwise) const {
    const bool is_known = triangle != kNoPlace;
    const Corners t = memory_.skin.corners(is_known ? triangle : otherwise);
    const Double3 p = is_known ? at : t.p[0], normal = normal_of(t);
    const double size = dot(normal, normal);
    SkinPoint out{to_float(p), surface_.triangles[is_known ? triangle : otherwise], {1, 0, 0}};
    if (size > 0) {
      const double v = dot(normal, cross(p - t.p[0], t.p[2] - t.p[0])) / size;
      const double w = dot(normal, cross(t.p[1] - t.p[0], p - t.p[0])) / size;
      out.weights[0] = static_cast<float>(1 - v - w);
      out.weights[1] = static_cast<float>(v);
      out.weights[2] = static_cast<float>(w);
    }
    return out;
  }

  Double3 previous_direction(std::size_t part_a, std::size_t part_b) const {
    for (std::size_t i = 0; i < job_.previous_count; ++i) {
      if (job_.previous[i].part_a == part_a && job_.previous[i].part_b == part_b) {
        return to_double(job_.previous[i].direction);
      }
    }
    return {0, 0, 0};
  }

  bool hangs_on(std::size_t a, std::size_t b) const { return asset_.part(a).parent == static_cast<std::int32_t>(b); }

  // Do both hang on the same third?
  bool are_siblings(std::size_t a, std::size_t b) const {
    return asset_.part(a).parent >= 0 && asset_.part(a).parent == asset_.part(b).parent;
  }

  // Does a hang on a part that hangs on b? A thigh and the abdomen, with the hips between.
  bool hangs_twice(std::size_t a, std::size_t b) const {
    const std::int32_t above = asset_.part(a).parent;
    return above >= 0 && hangs_on(static_cast<std::size_t>(above), b);
  }

  bool is_fold(const Contour& contour, std::size_t a, std::size_t b) const {
    if (a == b || hangs_on(a, b) || hangs_on(b, a) || contour.rest_distance < kNeighbourDistance * height_) {
      return true;  // the last: joints that no bones name
    }
    const bool are_near = hangs_twice(a, b) || hangs_twice(b, a);
    const bool lie_close = are_near && (contour.facing > kFoldFacing || !contour.is_one_piece);
    return (are_siblings(a, b) || lie_close) && contour.rest_distance < kFoldDistance * height_;
  }

  PenetrationClass class_of(const Contour& contour, const Penetration& of, double seen_length) const {
    // Files without a unit make giants and dwarfs.
    const double few = std::min(std::max(kTouchMetres * metre_, kTouchMin * height_), kTouchMax * height_);
    const double touch =
        job_.touch_depth > 0 ? double{job_.touch_depth} : few * (1 + (kTouchFlat - 1) * std::max(0.0, contour.facing));
    const double side = kTouchSide * std::min(few, touch);
    if (2 * contour.touching >= 1) {
      return SC_CLASS_REST;
    }
    if (double{of.visible} < kHidden || (!contour.is_one_piece && contour.rest_distance < kShellDistance * height_)) {
      return SC_CLASS_SHELL;
    }
    if (of.depth < touch) {
      return SC_CLASS_TOUCH;
    }
    if (is_fold(contour, of.part_a, of.part_b)) {
      return of.depth > kDeepFold * height_ && contour.is_one_piece ? SC_CLASS_DEEP_FOLD : SC_CLASS_FOLD;
    }
    return of.depth * seen_length < side * side ? SC_CLASS_TOUCH : SC_CLASS_PENETRATION;
  }

  const AssetView& asset_;
  const Surface& surface_;
  const PenetrationJob& job_;
  PairRule rule_;
  AssetInfo info_;
  double metre_, height_;
  Memory memory_;
  Sweep sweep_;
};

std::size_t scratch_words(const AssetView& asset, std::size_t contact_count) {
  if (!asset.is_open() || asset.skin().sizes.clusters == 0) {
    return 0;
  }
  Memory memory;
  const PairRule rule;
  Sweep sweep(memory.skin, rule, 0);
  return memory.lay_out(asset, contact_count, nullptr, sweep);
}

Status check_contacts(const PenetrationJob& job, const AssetView& asset, const Surface& surface) {
  const std::size_t parts = asset.part_count();
  for (std::size_t i = 0; i < job.contact_count; ++i) {
    const TriangleContact& contact = job.contacts[i];
    for (const std::uint32_t triangle : {contact.triangle_a, contact.triangle_b}) {
      if (triangle >= surface.place_of_source.size || surface.place_of_source[triangle] == kNoPlace ||
          surface.parts[surface.place_of_source[triangle]] >= parts) {
        return refuse(SC_BAD_VALUE, SC_FIELD_CONTACTS);
      }
    }
  }
  return done();
}

bool is_aliased(const PenetrationJob& job, const AssetView& asset) {
  const FilterRanges filter = ranges_of(job.filter);
  return any_shared(
      {range_of(Span<Penetration>{job.penetrations, job.penetration_capacity}),
       range_of(Span<std::uint64_t>{job.scratch, scratch_words(asset, job.contact_count)})},
      {range_of_vertices(asset, job.pose), range_of_bones(asset, job.pose), range_of_morph_weights(asset, job.pose),
       range_of(Span<const std::uint64_t>{job.skin_table, skin_table_words(asset)}), range_of(asset.ignored()),
       range_of(Span<const TriangleContact>{job.contacts, job.contact_count}),
       range_of(Span<const Penetration>{job.previous, job.previous_count}), filter.ignored, filter.disabled});
}

Status check(const PenetrationJob& job, Target& resolved, Surface& surface) {
  if (job.asset == nullptr) {
    return refuse(SC_NULL, SC_FIELD_ASSET);
  }
  const AssetView& asset = view_of(*job.asset);
  if (!asset.is_open()) {
    return refuse(SC_NOT_OPEN, SC_FIELD_ASSET);
  }
  if (asset.skin().sizes.clusters == 0) {
    return refuse(SC_NOT_IN_ASSET, SC_FIELD_ASSET);
  }
  const Status statuses[] = {check_skin_pose(asset, job.pose),
                             read_skin_table(asset, job.skin_table, surface),
                             job.filter == nullptr ? done() : check_filter(asset, *job.filter),
                             check_list(job.contacts, job.contact_count, SC_FIELD_CONTACTS),
                             check_list(job.previous, job.previous_count, SC_FIELD_PREVIOUS),
                             check_list(job.scratch, 1, SC_FIELD_SCRATCH),
                             check_list(job.penetrations, job.penetration_capacity, SC_FIELD_PENETRATIONS)};
  for (const Status& status : statuses) {
    if (status != SC_OK) {
      return status;
    }
  }
  if (job.scratch_words < scratch_words(asset, job.contact_count)) {
    return refuse(SC_TOO_SMALL, SC_FIELD_SCRATCH);
  }
  if (job.scope != SC_SCOPE_APART && job.scope != SC_SCOPE_NEIGHBOURS && job.scope != SC_SCOPE_ALL) {
    return refuse(SC_BAD_VALUE, SC_FIELD_SCOPE);
  }
  if (!(job.touch_depth >= 0) || !std::isfinite(job.touch_depth)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_TOUCH_DEPTH);
  }
  if (!resolve_target(job.target, resolved)) {
    return refuse(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET);
  }
  return is_aliased(job, asset) ? refuse(SC_ALIASED, SC_FIELD_OUTPUT) : check_contacts(job, asset, surface);
}

}  // namespace
}  // namespace spherechain

using namespace spherechain;

extern "C" {

size_t sc_penetration_scratch_words(const sc_asset* asset, size_t contact_count) noexcept {
  return asset == nullptr ? 0 : scratch_words(view_of(*asset), contact_count);
}

sc_status sc_measure_penetrations(sc_penetration_job* job) noexcept {
  if (job == nullptr) {
    return refuse(SC_NULL, SC_FIELD_NONE);
  }
  Target resolved{};
  Surface surface;
  const Status status = check(*job, resolved, surface);
  return status == SC_OK ? Measurer(view_of(*job->asset), surface, *job).run(resolved, *job) : status;
}

const char* sc_penetration_class_name(sc_penetration_class kind) noexcept {
  constexpr const char* kNames[] = {"rest", "shell", "touch", "fold", "deep_fold", "penetration"};
  return kind >= 0 && kind <= SC_CLASS_PENETRATION ? kNames[kind] : "unknown";
}

}  // extern "C"
