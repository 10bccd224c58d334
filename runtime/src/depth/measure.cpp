// SPDX-License-Identifier: MIT
// From triangles that meet to depth, direction, volume and class of each two body parts.
#include "depth/measure.h"

#include <algorithm>

#include "asset/status.h"
#include "depth/rule.h"
#include "depth/visibility.h"
#include "depth/way_out.h"

namespace spherechain {
namespace {

// Lengths are shares of the character's height, except where they are in metres.
constexpr double kGapMetres = 0.0006, kGapMax = 0.001;  // shorter free places on the way are none
constexpr double kNear = 0.006;
constexpr double kClearance = 3e-4;
constexpr std::uint64_t kCovered = std::uint64_t{1} << 31;  // bit of a contact's place in its list
constexpr double kAreaError = 0.03;  // if the contour has another area than the skin inside, the volume is not known

struct Memory {
  PosedSkin own, other;  // the latter of two bodies alone
  Skins skins;
  ContourScratch contour;
  Visibility visibility{skins};
  Span<std::uint64_t> keys;
  Span<Segment3> segments;
  Span<TriangleRun> side_a, side_b;  // of a part that meets itself

  explicit Memory(bool are_one) : skins{own, are_one ? own : other} {}

  std::size_t lay_out(const SkinSizes& a, const SkinSizes& b, std::size_t contact_count, std::uint64_t* words,
                      Sweep& sweep) {
    WordMemory memory(words);
    own.take(memory, a.vertices, a.clusters);
    if (!skins.are_one()) {
      other.take(memory, b.vertices, b.clusters);
    }
    contour.take(memory, contact_count, a.triangles + (skins.are_one() ? 0 : b.triangles));
    memory.take(keys, contact_count);
    memory.take(segments, contact_count);
    memory.take(side_a, contact_count);
    memory.take(side_b, contact_count);
    sweep.take(memory, a, b);
    return memory.used();
  }
};

class Measurer {
 public:
  explicit Measurer(const Meeting& in)
      : in_(in),
        surface_a_(*in.a.surface),
        surface_b_(*in.b.surface),
        rest_height_(double{in.a.asset->info().height}),
        height_(rest_height_ * scale_of(*in.a.asset, in.a.pose)),
        metre_(height_ / rest_height_ / double{in.a.asset->info().metres_per_unit}),
        rule_(rule_of(in.touch_depth)),
        memory_(in.are_one),
        sweep_(memory_.skins, in.rule, std::min(kGapMetres * metre_, kGapMax * height_)) {
    memory_.own.surface = in.a.surface;
    memory_.other.surface = in.b.surface;
    memory_.lay_out(in.a.asset->skin().sizes, in.b.asset->skin().sizes, in.contacts.size, in.scratch, sweep_);
  }

  Status run(std::size_t& found) {
    found = 0;
    if (in_.contacts.size == 0) {
      return done();
    }
    memory_.contour.clear(memory_.skins.triangle_count());
    sweep_.clear();
    pose_skins();
    const std::size_t count = sort_segments();
    for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
      while (end < count && memory_.keys[end] >> 32 == memory_.keys[begin] >> 32) {
        ++end;
      }
      if (found < in_.out.size) {
        const auto first_covered = std::find_if(memory_.keys.begin() + begin, memory_.keys.begin() + end,
                                                [](std::uint64_t key) { return (key & kCovered) != 0; });
        const auto seen = static_cast<std::size_t>(first_covered - (memory_.keys.begin() + begin));
        in_.out[found] = measure({memory_.segments.data + begin, end - begin}, seen);
      }
      ++found;
    }
    return in_.out.size > 0 && found > in_.out.size ? refuse(SC_OVERFLOW, SC_FIELD_PENETRATIONS) : done();
  }

 private:
  std::size_t part_a(const TriangleContact& contact) const {
    return surface_a_.parts[surface_a_.place_of_source[contact.triangle_a]];
  }
  std::size_t part_b(const TriangleContact& contact) const {
    return surface_b_.parts[surface_b_.place_of_source[contact.triangle_b]];
  }

  bool is_covered(const TriangleContact& contact) const {
    return memory_.skins.a.is_covered(surface_a_.place_of_source[contact.triangle_a]) ||
           memory_.skins.b.is_covered(surface_b_.place_of_source[contact.triangle_b]);
  }

  // Those parts alone that meet, where nothing else is looked at.
  void pose_skins() {
    if (!in_.quick) {
      memory_.own.fill(in_.a.pose, in_.target);
      if (!in_.are_one) {
        memory_.other.fill(in_.b.pose, in_.target);
      }
      return;
    }
    std::uint64_t parts[2][4] = {};
    const auto mark = [&](std::size_t body, std::size_t part) {
      parts[body][part / 64] |= std::uint64_t{1} << part % 64;
    };
    for (const TriangleContact& contact : in_.contacts) {
      mark(0, part_a(contact));
      mark(in_.are_one ? 0 : 1, part_b(contact));
    }
    memory_.own.fill(in_.a.pose, in_.target, parts[0]);
    if (!in_.are_one) {
      memory_.other.fill(in_.b.pose, in_.target, parts[1]);
    }
  }

  // Of a contact, part a's triangle first.
  Segment3 segment_of(const TriangleContact& contact) const {
    const PosedSkin &skin_a = memory_.skins.a, &skin_b = memory_.skins.b;
    Segment3 out{};
    out.a = surface_a_.place_of_source[contact.triangle_a];
    out.b = surface_b_.place_of_source[contact.triangle_b];
    if (in_.are_one && surface_a_.parts[out.a] > surface_a_.parts[out.b]) {
      std::swap(out.a, out.b);
    }
    out.normal_a = skin_a.handedness * normal_of(skin_a.corners(out.a));
    out.normal_b = skin_b.handedness * normal_of(skin_b.corners(out.b));
    out.normal_a = normalize(out.normal_a) ? out.normal_a : Double3{0, 0, 0};
    out.normal_b = normalize(out.normal_b) ? out.normal_b : Double3{0, 0, 0};
    out.from = to_double(contact.from);
    out.to = to_double(contact.to);
    if (dot(cross(out.normal_a, out.normal_b), out.to - out.from) < 0) {
      std::swap(out.from, out.to);
    }
    out.length = length(out.to - out.from);
    if (!std::isfinite(out.length)) {
      out.from = out.to = skin_a.corners(out.a).p[0];
      out.length = 0;
    }
    return out;
  }

  // By pairs of parts; of these first the contacts of outer layers, as they were given.
  std::size_t sort_segments() {
    std::size_t count = 0;
    for (std::size_t i = 0; i < in_.contacts.size; ++i) {
      const std::uint64_t p = part_a(in_.contacts[i]), q = part_b(in_.contacts[i]);
      const std::uint64_t place = i | (is_covered(in_.contacts[i]) ? kCovered : 0);
      memory_.keys[count++] =
          in_.are_one ? std::min(p, q) << 48 | std::max(p, q) << 32 | place : p << 48 | q << 32 | place;
    }
    std::sort(memory_.keys.begin(), memory_.keys.begin() + count,
              [](std::uint64_t l, std::uint64_t r) { return l < r; });
    for (std::size_t i = 0; i < count; ++i) {
      memory_.segments[i] = segment_of(in_.contacts[memory_.keys[i] & (kCovered - 1)]);
    }
    return count;
  }

  static Span<const TriangleRun> runs_of(const Surface& surface, std::size_t part) {
    const std::uint32_t first = surface.first_of_part[part];
    return {surface.part_runs.data + first, surface.first_of_part[part + 1] - first};
  }

  // Triangles each once.
  Span<const TriangleRun> unique(Span<TriangleRun> runs) const {
    const auto first = [](const TriangleRun& run) { return run.first; };
    std::sort(runs.begin(), runs.end(), [&](const auto& l, const auto& r) { return first(l) < first(r); });
    const auto end =
        std::unique(runs.begin(), runs.end(), [&](const auto& l, const auto& r) { return first(l) == first(r); });
    for (TriangleRun* run = runs.begin(); run != end; ++run) {
      const auto after = std::upper_bound(surface_a_.clusters.begin(), surface_a_.clusters.end(), run->first,
                                          [](std::uint32_t t, const Cluster& c) { return t < c.first_triangle; });
      run->cluster = static_cast<std::uint32_t>(after - surface_a_.clusters.begin() - 1);
    }
    return {runs.data, static_cast<std::size_t>(end - runs.begin())};
  }

  void set_sides(const Span<Segment3>& segments, const Double3& center, std::size_t part_a, std::size_t part_b) {
    if (!in_.are_one || part_a != part_b) {
      sweep_.set_sides(runs_of(surface_a_, part_a), runs_of(surface_b_, part_b), center);
      return;
    }
    const std::size_t count = segments.size;
    for (std::size_t i = 0; i < count; ++i) {
      memory_.side_a[i] = {0, segments[i].a, 1};
      memory_.side_b[i] = {0, segments[i].b, 1};
    }
    sweep_.set_sides(unique({memory_.side_a.data, count}), unique({memory_.side_b.data, count}), center);
  }

  // `seen`: how many of the segments, the first, are of outer layers. Where there are any, the others lie below a suit,
  // or are its lining: they must come out, but say nothing of what a person sees.
  Penetration measure(Span<Segment3> all, std::size_t seen_count) {
    has_outer_layers_ = seen_count > 0;
    const Span<Segment3> segments{all.data, has_outer_layers_ ? seen_count : all.size};
    const std::size_t part_a = surface_a_.parts[segments[0].a], part_b = surface_b_.parts[segments[0].b];
    const Contour contour = contour_of(memory_.skins, segments, rest_height_, memory_.contour);
    set_sides(all, contour.center, part_a, part_b);
    const Double3 previous = previous_direction(part_a, part_b);
    const bool has_previous = dot(previous, previous) > 0 && std::isfinite(dot(previous, previous));
    Measures measures = measures_of(contour, part_a, part_b);
    const double deep = is_fold(rule_, measures) ? rule_.deep_fold * height_ : 0;
    const Exit exit = find_exit(sweep_, contour,
                                {in_.quick, kNear * height_, deep, are_joined(part_a, part_b),
                                 has_previous && !in_.quick ? &previous : nullptr});
    Penetration out{};
    out.part_a = static_cast<std::uint32_t>(part_a);
    out.part_b = static_cast<std::uint32_t>(part_b);
    // Triangles that just touch are clear of each other after any move: the least there is.
    out.depth = std::max(static_cast<float>(exit.way.depth), static_cast<float>(1e-7 * height_));
    out.direction = to_float(exit.direction);
    out.contour_length = static_cast<float>(contour.length);
    out.deepest_a = point_of(memory_.skins.a, exit.way.a, exit.way.point_a, segments[0].a);
    out.deepest_b = point_of(memory_.skins.b, exit.way.b, exit.way.point_b, segments[0].b);
    // All of the line is in sight, as far as its own sides do not hide it.
    Seen seen{1, contour.length * std::sqrt(std::max(0.0, 1 - contour.facing) / 2)};
    if (!in_.quick) {
      if (contour.is_closed && (!in_.are_one || part_a != part_b)) {
        sweep_.keep_on_way(exit.direction, exit.way.depth);
        const Volume volume = sweep_.volume(exit.direction, exit.way.depth, has_outer_layers_);
        const double area = dot(contour.area, exit.direction);
        out.is_closed = std::abs(volume.area - area) <= kAreaError * volume.total && volume.volume >= 0 ? 1 : 0;
        out.volume = out.is_closed != 0 ? static_cast<float>(volume.volume) : 0;
      }
      Double3 axes[3];
      axes_of(contour, exit.direction, axes);
      seen = memory_.visibility.look(contour, axes, kClearance * height_);
      if (seen.share < rule_.hidden && segments.size < all.size) {  // in sight below an open coat?
        const Seen below = memory_.visibility.look(contour_of(memory_.skins, all, rest_height_, memory_.contour), axes,
                                                   kClearance * height_);
        seen = below.share > seen.share ? below : seen;
      }
    }
    out.visible = static_cast<float>(seen.share);
    measures.depth = double{out.depth};
    measures.visible = double{out.visible};
    if (depends_on_swallowed(rule_, measures)) {
      measures.swallowed = swallowed(contour, out, seen.length);
    }
    out.kind = classify(rule_, measures);
    return out;
  }

  static SkinPoint point_of(const PosedSkin& skin, std::uint32_t triangle, const Double3& at, std::uint32_t otherwise) {
    const bool is_known = triangle != kNoPlace;
    const Corners t = skin.corners(is_known ? triangle : otherwise);
    const Double3 p = is_known ? at : t.p[0], normal = normal_of(t);
    const double size = dot(normal, normal);
    SkinPoint out{to_float(p), skin.surface->triangles[is_known ? triangle : otherwise], {1, 0, 0}};
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
    for (const Penetration& last : in_.previous) {
      if (last.part_a == part_a && last.part_b == part_b) {
        return to_double(last.direction);
      }
    }
    return {0, 0, 0};
  }

  bool hangs_on(std::size_t a, std::size_t b) const {
    return in_.a.asset->part(a).parent == static_cast<std::int32_t>(b);
  }

  bool are_joined(std::size_t a, std::size_t b) const { return in_.are_one && (hangs_on(a, b) || hangs_on(b, a)); }

  // Do both hang on the same third?
  bool are_siblings(std::size_t a, std::size_t b) const {
    return in_.a.asset->part(a).parent >= 0 && in_.a.asset->part(a).parent == in_.a.asset->part(b).parent;
  }

  // Does a hang on a part that hangs on b? A thigh and the abdomen, with the hips between.
  bool hangs_twice(std::size_t a, std::size_t b) const {
    const std::int32_t above = in_.a.asset->part(a).parent;
    return above >= 0 && hangs_on(static_cast<std::size_t>(above), b);
  }

  Measures measures_of(const Contour& contour, std::size_t a, std::size_t b) const {
    const Relation relation = !in_.are_one                             ? Relation::kApart
                              : a == b || are_joined(a, b)             ? Relation::kJoined
                              : are_siblings(a, b)                     ? Relation::kSiblings
                              : hangs_twice(a, b) || hangs_twice(b, a) ? Relation::kNear
                                                                       : Relation::kApart;
    return {height_,
            metre_,
            relation,
            !in_.are_one,
            contour.is_one_piece,
            contour.rest_distance / rest_height_,
            contour.touching,
            contour.facing};
  }

  // How far a part's skin goes on from a point on it, into that direction.
  double thickness(const PosedSkin& skin, std::size_t part, Vec3 at, const Double3& direction) const {
    const Ray ray(to_double(at), direction);
    double least = HUGE_VAL;
    for (const TriangleRun& run : runs_of(*skin.surface, part)) {
      if (!ray.meets(skin.low, skin.high, run.cluster)) {
        continue;
      }
      for (std::uint32_t t = run.first; t < run.first + run.count; ++t) {
        if (has_outer_layers_ && skin.is_covered(t)) {
          continue;
        }
        const double reach = ray.reach(skin.corners(t));
        least = reach > kClearance * height_ ? std::min(least, reach) : least;
      }
    }
    return least;
  }

  // See Measures.
  double swallowed(const Contour& contour, const Penetration& of, double seen_length) const {
    const double scale_a = height_ / rest_height_;
    const double scale_b = in_.are_one ? scale_a : scale_of(*in_.b.asset, in_.b.pose);
    double radius_a = 0, radius_b = 0;  // mean of the spheres whose skin meets
    for (const Segment3& s : contour.segments) {
      radius_a += s.length * double{in_.a.asset->spheres()[surface_a_.triangle_spheres[s.a]].radius};
      radius_b += s.length * double{in_.b.asset->spheres()[surface_b_.triangle_spheres[s.b]].radius};
    }
    const Double3 out = to_double(of.direction);
    const double thin = std::min({2 * std::min(scale_a * radius_a, scale_b * radius_b) / contour.length,
                                  thickness(memory_.skins.a, of.part_a, of.deepest_a.position, -1.0 * out),
                                  thickness(memory_.skins.b, of.part_b, of.deepest_b.position, out)});
    const double side = std::min(scale_a * std::sqrt(double{surface_a_.part_areas[of.part_a]}),
                                 scale_b * std::sqrt(double{surface_b_.part_areas[of.part_b]}));
    return double{of.depth} / thin * seen_length / side;
  }

  const Meeting& in_;
  const Surface &surface_a_, &surface_b_;
  double rest_height_, height_, metre_;  // at rest; in the pose
  Rule rule_;
  Memory memory_;
  Sweep sweep_;
  bool has_outer_layers_ = false;  // of the two parts that are measured: covered triangles do not count
};

}  // namespace

std::size_t measure_words(const AssetView& a, const AssetView& b, bool are_one, std::size_t contact_count) {
  Memory memory(are_one);
  const PairRule rule;
  Sweep sweep(memory.skins, rule, 0);
  return memory.lay_out(a.skin().sizes, b.skin().sizes, contact_count, nullptr, sweep);
}

Status check_contacts(const Meeting& meeting) {
  const auto is_known = [](const Meeting::Side& side, std::uint32_t triangle) {
    const Surface& surface = *side.surface;
    return triangle < surface.place_of_source.size && surface.place_of_source[triangle] != kNoPlace &&
           surface.parts[surface.place_of_source[triangle]] < side.asset->part_count();
  };
  for (const TriangleContact& contact : meeting.contacts) {
    if (!is_known(meeting.a, contact.triangle_a) || !is_known(meeting.b, contact.triangle_b)) {
      return refuse(SC_BAD_VALUE, SC_FIELD_CONTACTS);
    }
  }
  return done();
}

Status measure(const Meeting& meeting, std::size_t& count) { return Measurer(meeting).run(count); }

}  // namespace spherechain
