// SPDX-License-Identifier: MIT
// From triangles that meet to depth, direction, volume and class of each two body parts.
#include "runtime/src/penetrations/measure.h"

#include <algorithm>
#include <utility>

#include "runtime/src/base/status.h"
#include "runtime/src/contacts/part_table.h"
#include "runtime/src/depth/way_out.h"
#include "runtime/src/inside/containment.h"
#include "runtime/src/penetrations/rule.h"
#include "runtime/src/penetrations/visibility.h"

namespace spherechain {
namespace {

// Lengths are shares of the character's height, except where they are in metres.
constexpr double kGapMetres = 0.0006, kGapMax = 0.001;  // shorter free places on the way are none
constexpr double kNear = 0.006;
constexpr double kClearance = 3e-4;
constexpr double kFar = 100;                                // no pose is as large
constexpr std::uint64_t kCovered = std::uint64_t{1} << 31;  // bit of a contact's place in its list
constexpr double kAreaError = 0.03;  // if the contour has another area than the skin inside, the volume is not known

std::size_t most_runs(const SkinData& skin) { return skin.part_runs.size + skin.sizes.clusters; }

struct Memory {
  PosedSkin own, other;  // the latter of two bodies alone
  Skins skins;
  ContourScratch contour;
  Visibility visibility{skins};
  Span<std::uint64_t> keys;
  Span<Segment3> segments;
  Span<TriangleRun> side_a, side_b;  // of a part that meets itself
  Span<TriangleRun> around;          // of the parts around one that is inside

  explicit Memory(bool are_one) : skins{own, are_one ? own : other} {}

  std::size_t lay_out(const SkinData& skin_a, const SkinData& skin_b, std::size_t contact_count, std::uint64_t* words,
                      Sweep& sweep) {
    const SkinSizes &a = skin_a.sizes, &b = skin_b.sizes;
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
    memory.take(around, std::max(most_runs(skin_a), most_runs(skin_b)));
    sweep.take(memory, a, b);
    return memory.used();
  }
};

class Measurer {
 public:
  explicit Measurer(const Meeting& in)
      : in_(in),
        eased_(eased(in.limits)),
        limits_(&in.limits),
        surface_a_(*in.a.surface),
        surface_b_(*in.b.surface),
        rest_height_(double{in.a.asset->info().height}),
        height_(rest_height_ * scale_of(*in.a.asset, in.a.pose)),
        metre_(height_ / rest_height_ / double{in.a.asset->info().metres_per_unit}),
        memory_(in.are_one),
        core_a_(*in.a.asset, surface_a_, in.inside_a),
        core_b_(*in.b.asset, surface_b_, in.are_one ? in.inside_a : in.inside_b),
        gap_(std::min(kGapMetres * metre_, kGapMax * height_)),
        sweep_(memory_.skins, in.rule, gap_) {
    memory_.own.surface = in.a.surface;
    memory_.other.surface = in.b.surface;
    memory_.lay_out(in.a.asset->skin(), in.b.asset->skin(), in.contacts.size, in.scratch, sweep_);
  }

  Status run(std::size_t& found) {
    found = in_.kept;
    if (in_.contacts.size > 0) {
      memory_.contour.clear(memory_.skins.triangle_count());
      sweep_.clear();
      pose_skins();
    }
    const std::size_t count = sort_segments();
    for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
      while (end < count && memory_.keys[end] >> 32 == memory_.keys[begin] >> 32) {
        ++end;
      }
      if (in_.out.size > 0) {
        const auto first_covered = std::find_if(memory_.keys.begin() + begin, memory_.keys.begin() + end,
                                                [](std::uint64_t key) { return (key & kCovered) != 0; });
        const auto seen = static_cast<std::size_t>(first_covered - (memory_.keys.begin() + begin));
        const Penetration one = measure(two_parts({memory_.segments.data + begin, end - begin}, seen));
        if ((in_.classes >> one.kind & 1) == 0) {
          continue;
        }
        keep_worst(in_.out, one, found);
      }
      ++found;
    }
    if (in_.adds_enclosed && in_.out.size > 0 && (in_.classes >> SC_CLASS_INSIDE & 1) != 0) {
      add_enclosed(core_a_, false, found);
      if (!in_.are_one) {
        add_enclosed(core_b_, true, found);
      }
    }
    if (in_.out.size == 0 || found <= in_.out.size) {
      return done();
    }
    const auto parts = [](const Penetration& of) { return std::minmax(of.part, of.other); };
    std::sort(in_.out.begin(), in_.out.end(), [&](const auto& l, const auto& r) { return parts(l) < parts(r); });
    return refuse(SC_OVERFLOW, SC_FIELD_PENETRATIONS);
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

  // Poses only the parts that are in contact, if nothing else is looked at.
  void pose_skins() {
    if (!in_.quick) {
      pose_all_skins();
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

  void pose_all_skins() {
    if (std::exchange(are_all_posed_, true)) {
      return;
    }
    memory_.own.fill(in_.a.pose, in_.target);
    if (!in_.are_one) {
      memory_.other.fill(in_.b.pose, in_.target);
    }
  }

  // The segment in which the triangles of a contact cross, with part a's triangle first.
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

  // Triangles each once.
  Span<const TriangleRun> unique(Span<TriangleRun> runs) const {
    const auto first = [](const TriangleRun& run) { return run.first; };
    std::sort(runs.begin(), runs.end(), [&](const auto& l, const auto& r) { return first(l) < first(r); });
    const auto end =
        std::unique(runs.begin(), runs.end(), [&](const auto& l, const auto& r) { return first(l) == first(r); });
    for (TriangleRun* run = runs.begin(); run != end; ++run) {
      run->cluster = cluster_of(surface_a_, run->first);
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

  // Two parts that meet. Where some segments are of outer layers, the others lie below a suit, or are its lining: they
  // must come out, but say nothing of what a person sees.
  struct TwoParts {
    Span<Segment3> all;
    std::size_t a, b;
    Contour contour;          // of what a person sees
    bool swaps;               // b is named first
    double side;              // of a square like the smaller part
    double swallowed = 0;     // share of the one that is inside the other
    bool b_is_inner = false;  // it is b
    bool passes_through = false;
    double containment = 0;  // see containment_of()
    double apart = 0;        // where it is above 0: how far the inner part is from being clear of all around it
    Exit way_apart;
  };

  // `seen`: how many of the segments, the first, are of outer layers.
  TwoParts two_parts(Span<Segment3> all, std::size_t seen) {
    has_outer_layers_ = seen > 0;
    TwoParts out{all, surface_a_.parts[all[0].a], surface_b_.parts[all[0].b], {}, false, 0, 0, false, false, 0, 0, {}};
    out.contour = contour_of(memory_.skins, {all.data, seen > 0 ? seen : all.size}, rest_height_, memory_.contour);
    const double area_a = double{surface_a_.part_areas[out.a]}, area_b = double{surface_b_.part_areas[out.b]};
    const int mobility_a = in_.a.asset->part(out.a).mobility, mobility_b = in_.b.asset->part(out.b).mobility;
    out.swaps =
        in_.are_one && out.a != out.b && (mobility_b > mobility_a || (mobility_b == mobility_a && area_b < area_a));
    set_swallowed(out);
    out.side = std::min(scale_of_a() * std::sqrt(area_a), scale_of_b() * std::sqrt(area_b));
    return out;
  }

  // The part that is inside the other is named first, where both are of one body.
  void set_swallowed(TwoParts& parts) const {
    const double a = core_a_.swallowed(parts.a, parts.b), b = core_b_.swallowed(parts.b, parts.a);
    if (in_.are_one && containment_of(in_.limits, std::max(a, b)) > 0 && a != b) {
      parts.swaps = b > a;
    }
    parts.b_is_inner = in_.are_one ? parts.swaps : b > a;
    parts.swallowed = parts.b_is_inner ? b : a;
    parts.passes_through =
        parts.b_is_inner ? core_b_.passes_through(parts.b, parts.a) : core_a_.passes_through(parts.a, parts.b);
    parts.containment = containment_of(in_.limits, parts.swallowed);
  }

  // Parts that are inside another, where no triangles meet.
  void add_enclosed(const Containment& core, bool is_of_b, std::size_t& found) {
    const AssetView& asset = is_of_b ? *in_.b.asset : *in_.a.asset;
    for (std::size_t part = 0; part < asset.part_count(); ++part) {
      const Containment::Holder holder = core.holder_of(part);
      if (holder.part == kOutside || holder.share < double{in_.limits.inside}) {
        continue;
      }
      TwoParts parts{};
      parts.a = in_.are_one || is_of_b ? holder.part : part;
      parts.b = in_.are_one || is_of_b ? part : holder.part;
      parts.swaps = in_.are_one;
      if (is_wanted(parts)) {
        parts.b_is_inner = in_.are_one || is_of_b;
        parts.swallowed = holder.share;
        parts.passes_through = core.passes_through(part, holder.part);
        parts.containment = 1;
        keep_worst(in_.out, measure_enclosed(parts), found);
        ++found;
      }
    }
  }

  // Have they no contact, and does the query ask about them?
  bool is_wanted(const TwoParts& parts) const {
    const std::size_t a = in_.are_one ? std::min(parts.a, parts.b) : parts.a;
    const std::size_t b = in_.are_one ? std::max(parts.a, parts.b) : parts.b;
    const bool have_met = std::any_of(in_.met.begin(), in_.met.end(),
                                      [&](const PartContact& met) { return met.part_a == a && met.part_b == b; });
    TableOfParts<PartContact> places;
    places.count_b = in_.b.asset->part_count();
    const std::size_t place = places.place(a, b, in_.are_one);
    return !have_met && (in_.part_pairs == nullptr || (in_.part_pairs[place / 64] >> place % 64 & 1) != 0);
  }

  // The triangles of the parts that hold some of the inner one's core, and of those that these hang together with: the
  // inner one may come out of them, too. The parts that it hangs together with itself are left out, where both are of
  // one body.
  Span<const TriangleRun> runs_around(const TwoParts& parts) {
    const Surface& surface = parts.b_is_inner ? surface_a_ : surface_b_;
    const AssetView& asset = parts.b_is_inner ? *in_.a.asset : *in_.b.asset;
    const std::size_t outer = parts.b_is_inner ? parts.a : parts.b, inner = parts.b_is_inner ? parts.b : parts.a;
    std::size_t count = 0;
    bool holds[kMaxPartCount + 1] = {};
    (parts.b_is_inner ? core_b_ : core_a_).mark_holders(inner, holds);
    for (std::size_t part = 0; part < asset.part_count(); ++part) {
      const auto is_joined = [&](std::size_t to) {
        return asset.part(part).parent == static_cast<std::int32_t>(to) ||
               asset.part(to).parent == static_cast<std::int32_t>(part);
      };
      const bool is_own = in_.are_one && (part == inner || is_joined(inner));
      bool is_around = holds[part];
      for (std::size_t holder = 0; holder < asset.part_count(); ++holder) {
        is_around = is_around || (holds[holder] && is_joined(holder));
      }
      if (part == outer || (is_around && !is_own)) {
        const Span<const TriangleRun> runs = runs_of(surface, part);
        std::copy(runs.begin(), runs.end(), memory_.around.data + count);
        count += runs.size;
      }
    }
    return {memory_.around.data, count};
  }

  // Finds the way out of one that is inside, clear of all around it: nothing says which free place on the way is
  // outside.
  void part_them(TwoParts& parts) {
    pose_all_skins();
    const Span<const TriangleRun> around = runs_around(parts);
    if (parts.b_is_inner) {
      sweep_.set_sides(around, runs_of(surface_b_, parts.b), parts.contour.center);
    } else {
      sweep_.set_sides(runs_of(surface_a_, parts.a), around, parts.contour.center);
    }
    sweep_.set_gap(kFar * height_);
    parts.way_apart = parting_exit(sweep_);
    parts.apart = parts.way_apart.way.depth;
    Double3 previous = previous_direction(parts);
    if (normalize(previous)) {
      parts.way_apart = steady_exit(sweep_, Contour(), {0, true}, parts.way_apart, previous);
    }
    sweep_.set_gap(gap_);
  }

  Penetration measure_enclosed(TwoParts& parts) {
    if (in_.contacts.size == 0) {
      sweep_.clear();
    }
    pose_all_skins();
    Double3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -1.0 * low;
    const PosedSkin& skin = parts.b_is_inner ? memory_.skins.b : memory_.skins.a;
    for (const TriangleRun& run : runs_of(*skin.surface, parts.b_is_inner ? parts.b : parts.a)) {
      const std::uint32_t c = run.cluster;
      low = {std::min(low.x, double{skin.low[0][c]}), std::min(low.y, double{skin.low[1][c]}),
             std::min(low.z, double{skin.low[2][c]})};
      high = {std::max(high.x, double{skin.high[0][c]}), std::max(high.y, double{skin.high[1][c]}),
              std::max(high.z, double{skin.high[2][c]})};
    }
    parts.contour.center = 0.5 * (low + high);
    parts.contour.rest_distance = HUGE_VAL;
    part_them(parts);
    limits_ = &in_.limits;
    Penetration out = describe(parts, parts.way_apart, {0, 0}, nullptr);
    out.low = to_float(low);
    out.high = to_float(high);
    return out;
  }

  Penetration measure(TwoParts parts) {
    const Contour& contour = parts.contour;
    limits_ = was_fault(parts) ? &eased_ : &in_.limits;
    if (lists_faults_alone() && !may_be_fault(*limits_, measures_of(parts))) {
      return {};
    }
    if (parts.containment > 0) {
      part_them(parts);
    }
    set_sides(parts.all, contour.center, parts.a, parts.b);
    Exit exit = first_exit(sweep_, contour, kNear * height_);
    // All of the line is in sight, as far as its own sides do not hide it.
    const Seen in_sight{1, contour.length * std::sqrt(std::max(0.0, 1 - contour.facing) / 2)};
    const Penetration quick = describe(parts, exit, in_sight, nullptr);
    const bool is_likely = is_fault(quick.kind);
    if (in_.quick && !is_likely) {
      return quick;
    }
    pose_all_skins();
    const ExitSettings settings{fold_depth_of(in_.limits, quick.measures), are_joined(parts.a, parts.b)};
    Double3 previous = previous_direction(parts);
    const bool is_kept = normalize(previous);
    if (in_.along && is_kept) {
      return describe(parts, steady_exit(sweep_, contour, settings, exit, previous), in_sight, &quick);
    }
    exit = shortest_exit(sweep_, contour, settings, exit);
    Double3 axes[3];
    axes_of(contour, exit.direction, axes);
    // A contact that the quick measures alone class as no fault stays no fault: both forms must agree. Its extent is
    // known, and the seen length matters for that alone.
    Penetration out = describe(parts, exit, look(parts, axes, is_likely), is_likely ? nullptr : &quick);
    if (is_fault(out.kind) && is_kept) {
      set_way(parts, steady_exit(sweep_, contour, settings, exit, previous), out);
    }
    if (!in_.quick) {
      out.measures.volume = volume_of(parts, exit);
    }
    return out;
  }

  Seen look(const TwoParts& parts, const Double3 (&axes)[3], bool wants_length) {
    const Gaze gaze{kClearance * height_, wants_length};
    const Seen seen = memory_.visibility.look(parts.contour, axes, gaze);
    // From twice `hidden` on, more changes neither class nor fault depth.
    if (!(seen.share < 2 * double{in_.limits.hidden}) || parts.contour.segments.size == parts.all.size) {
      return seen;
    }
    // In sight below an open coat?
    const Seen below =
        memory_.visibility.look(contour_of(memory_.skins, parts.all, rest_height_, memory_.contour), axes, gaze);
    return below.share > seen.share ? below : seen;
  }

  // Negative where it is not known.
  float volume_of(const TwoParts& parts, const Exit& exit) {
    if (!parts.contour.is_closed || (in_.are_one && parts.a == parts.b)) {
      return -1;
    }
    const Volume volume = sweep_.volume(exit.direction, exit.way.depth, has_outer_layers_);
    const double area = dot(parts.contour.area, exit.direction);
    const bool is_known = std::abs(volume.area - area) <= kAreaError * volume.total && volume.volume >= 0;
    return is_known ? static_cast<float>(volume.volume) : -1;
  }

  bool lists_faults_alone() const {
    return in_.along || in_.classes >> SC_CLASS_DEEP_FOLD << SC_CLASS_DEEP_FOLD == in_.classes;
  }

  // The measurements that need no way out.
  Measures measures_of(const TwoParts& parts) const {
    const Contour& contour = parts.contour;
    Measures out{};
    out.volume = out.thickness = out.extent = -1;
    out.contour_length = static_cast<float>(contour.length);
    out.visible = 1;
    out.touching = static_cast<float>(contour.touching);
    out.facing = static_cast<float>(contour.facing);
    out.rest_distance = static_cast<float>(contour.rest_distance / rest_height_);
    out.height = static_cast<float>(height_);
    out.metre = static_cast<float>(metre_);
    out.relation = relation_of(parts.a, parts.b);
    out.is_one_piece = contour.is_one_piece ? 1 : 0;
    out.swallowed = static_cast<float>(parts.swallowed);
    out.through = parts.passes_through ? 1 : 0;
    return out;
  }

  // `known`: has the same parts' thickness, and how much is swallowed; or null.
  Penetration describe(const TwoParts& parts, const Exit& exit, const Seen& seen, const Penetration* known) {
    const Contour& contour = parts.contour;
    Penetration out{};
    set_way(parts, exit, out);
    // The nearer a part is to being inside, the less it is out once just its contact is gone.
    const double more = std::max(parts.apart - exit.way.depth, 0.0);
    out.measures = measures_of(parts);
    out.measures.depth = least_depth(exit.way.depth + parts.containment * more);
    out.measures.visible = static_cast<float>(seen.share);
    if (known != nullptr) {
      out.measures.thickness = known->measures.thickness;
      out.measures.extent = known->measures.extent;
    } else if (depends_on_extent(*limits_, out.measures) || depends_on_extent(in_.limits, out.measures)) {
      const SkinPoint &a = parts.swaps ? out.deepest_other : out.deepest,
                      &b = parts.swaps ? out.deepest : out.deepest_other;
      const double thin = thickness_of(parts, exit.direction, a.position, b.position);
      out.measures.thickness = static_cast<float>(thin);
      out.measures.extent = static_cast<float>(double{out.measures.depth} / thin * seen.length / parts.side);
    }
    out.kind = sc_classify(limits_, &out.measures);
    out.fault_depth = fault_depth_of(in_.limits, out.measures);
    out.part = static_cast<std::uint32_t>(parts.swaps ? parts.b : parts.a);
    out.other = static_cast<std::uint32_t>(parts.swaps ? parts.a : parts.b);
    out.joint = static_cast<std::uint32_t>(in_.a.asset->part(out.part).bone);  // -1 is SC_NO_JOINT
    out.centre = to_float(contour.center);
    if (parts.all.size > 0) {
      set_box(parts.all, out);
    }
    return out;
  }

  // Triangles that just touch are clear of each other after any move: the least there is.
  float least_depth(double depth) const {
    return std::max(static_cast<float>(depth), static_cast<float>(1e-7 * height_));
  }

  // An exit moves b. A part that is more inside than not parts from all around it, where that is farther.
  void set_way(const TwoParts& parts, const Exit& of_contact, Penetration& out) const {
    const Exit& exit = parts.containment >= 0.5 && parts.apart > of_contact.way.depth ? parts.way_apart : of_contact;
    out.distance = least_depth(exit.way.depth);
    out.direction = to_float(parts.swaps ? exit.direction : -1.0 * exit.direction);
    const bool meet = parts.contour.segments.size > 0;
    const std::uint32_t any_a = meet ? parts.contour.segments[0].a : runs_of(surface_a_, parts.a)[0].first;
    const std::uint32_t any_b = meet ? parts.contour.segments[0].b : runs_of(surface_b_, parts.b)[0].first;
    out.deepest = point_of(memory_.skins.a, exit.way.a, exit.way.point_a, any_a);
    out.deepest_other = point_of(memory_.skins.b, exit.way.b, exit.way.point_b, any_b);
    if (parts.swaps) {
      std::swap(out.deepest, out.deepest_other);
    }
  }

  static void set_box(const Span<Segment3>& segments, Penetration& out) {
    Double3 low = segments[0].from, high = low;
    for (const Segment3& s : segments) {
      for (const Double3& p : {s.from, s.to}) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
      }
    }
    out.low = to_float(low);
    out.high = to_float(high);
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

  // In which the last frame moved part b out of a fault; zero where there is none.
  Double3 previous_direction(const TwoParts& parts) const {
    for (const Penetration& last : in_.previous) {
      if (last.part == (parts.swaps ? parts.b : parts.a) && last.other == (parts.swaps ? parts.a : parts.b) &&
          is_fault(last.kind)) {
        return (parts.swaps ? 1.0 : -1.0) * to_double(last.direction);
      }
    }
    return {0, 0, 0};
  }

  bool was_fault(const TwoParts& parts) const {
    return std::any_of(in_.previous.begin(), in_.previous.end(), [&](const Penetration& last) {
      const bool are_these = last.part == parts.a && last.other == parts.b;
      const bool are_swapped = in_.are_one && last.part == parts.b && last.other == parts.a;
      return (are_these || are_swapped) && is_fault(last.kind);
    });
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

  Relation relation_of(std::size_t a, std::size_t b) const {
    return !in_.are_one                             ? SC_RELATION_TWO_BODIES
           : a == b || are_joined(a, b)             ? SC_RELATION_JOINED
           : are_siblings(a, b)                     ? SC_RELATION_SIBLINGS
           : hangs_twice(a, b) || hangs_twice(b, a) ? SC_RELATION_NEAR
                                                    : SC_RELATION_APART;
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

  double scale_of_a() const { return height_ / rest_height_; }
  double scale_of_b() const { return in_.are_one ? scale_of_a() : scale_of(*in_.b.asset, in_.b.pose); }

  // Thickness of the thinner part at the contact: at the deepest points, or that of its spheres there.
  double thickness_of(const TwoParts& parts, const Double3& direction, const Vec3& deepest_a,
                      const Vec3& deepest_b) const {
    double radius_a = 0, radius_b = 0;  // mean of the spheres whose skin meets
    for (const Segment3& s : parts.contour.segments) {
      radius_a += s.length * double{in_.a.asset->spheres()[surface_a_.triangle_spheres[s.a]].radius};
      radius_b += s.length * double{in_.b.asset->spheres()[surface_b_.triangle_spheres[s.b]].radius};
    }
    return std::min({2 * std::min(scale_of_a() * radius_a, scale_of_b() * radius_b) / parts.contour.length,
                     thickness(memory_.skins.a, parts.a, deepest_a, -1.0 * direction),
                     thickness(memory_.skins.b, parts.b, deepest_b, direction)});
  }

  const Meeting& in_;
  const Rule eased_;
  const Rule* limits_;  // of the two parts that are measured: the query's, or eased_
  const Surface &surface_a_, &surface_b_;
  double rest_height_, height_, metre_;  // at rest; in the pose
  Memory memory_;
  Containment core_a_, core_b_;
  double gap_;
  Sweep sweep_;
  bool are_all_posed_ = false;
  bool has_outer_layers_ = false;  // of the two parts that are measured: covered triangles do not count
};

}  // namespace

void keep_worst(Span<Penetration> list, const Penetration& one, std::size_t count) {
  Penetration* const place =
      count < list.size ? list.data + count : std::max_element(list.begin(), list.end(), is_worse);
  if (count < list.size || is_worse(one, *place)) {
    *place = one;
  }
}

std::size_t measure_words(const AssetView& a, const AssetView& b, bool are_one, std::size_t contact_count) {
  Memory memory(are_one);
  const PairRule rule;
  Sweep sweep(memory.skins, rule, 0);
  return memory.lay_out(a.skin(), b.skin(), contact_count, nullptr, sweep);
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
