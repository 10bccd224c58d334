// SPDX-License-Identifier: MIT
#include "runtime/src/gaps/gaps.h"

#include <algorithm>
#include <cmath>

#include "runtime/src/base/pair_bits.h"
#include "runtime/src/clusters/set_up.h"
#include "runtime/src/depth/distance.h"
#include "runtime/src/skin/left_out.h"

namespace spherechain {
namespace {

constexpr double kFaces = -0.1;     // the cosine of a triangle's normal and the way to the other one, at least
constexpr double kTurnsAway = 0.5;  // the cosine of two triangles' normals, at most
constexpr double kFold = 0.008;     // of the height: skins that are so near at rest have no gap

// A bit for each body part.
struct PartBits {
  std::uint64_t words[4];

  void add(std::size_t part) { words[part / 64] |= std::uint64_t{1} << part % 64; }
  void add(const PartBits& all) {
    for (std::size_t i = 0; i < 4; ++i) {
      words[i] |= all.words[i];
    }
  }
  bool has(std::size_t part) const { return (words[part / 64] >> part % 64 & 1) != 0; }
  bool meets(const PartBits& other) const {
    return ((words[0] & other.words[0]) | (words[1] & other.words[1]) | (words[2] & other.words[2]) |
            (words[3] & other.words[3])) != 0;
  }
};
static_assert(8 * sizeof(PartBits) > kMaxPartCount);

// Gives each sphere of `surface` what `of_part` says of its parts: it has triangles of several.
template <typename OfPart>
void join_parts(const Surface& surface, Span<PartBits> spheres, const OfPart& of_part) {
  std::fill(spheres.begin(), spheres.end(), PartBits{});
  for (std::size_t part = 0; part + 1 < surface.first_of_part.size; ++part) {
    for (const TriangleRun& run : runs_of(surface, part)) {
      spheres[surface.triangle_spheres[run.first]].add(of_part(part));
    }
  }
}

struct Memory {
  PosedClusters a, b;
  Span<PartBits> asked;  // of each part of a: those of b that it is asked about with
  Span<PartBits> asks;   // of each sphere of a: the same, of all its parts
  Span<PartBits> parts;  // of each sphere of b

  std::size_t lay_out(const AssetView& asset_a, const AssetView& asset_b, bool are_one, std::uint64_t* words) {
    WordMemory memory(words);
    spherechain::lay_out(asset_a, memory, a);
    if (!are_one) {
      spherechain::lay_out(asset_b, memory, b);
    }
    memory.take(asked, asset_a.part_count());
    memory.take(asks, asset_a.spheres().size);
    memory.take(parts, asset_b.spheres().size);
    return memory.used();
  }
};

// -1: the pose mirrors the skin, and its triangles turn the other way.
double handedness_of(const Pose& pose) {
  if (pose.bones == nullptr) {
    return 1;
  }
  const BoneMatrices bones = matrices_of(pose);
  const auto column = [&](std::size_t j) {
    const float* const m = bones.data + j * bones.column;
    return Double3{double{m[0]}, double{m[bones.row]}, double{m[2 * bones.row]}};
  };
  return dot(cross(column(0), column(1)), column(2)) < 0 ? -1 : 1;
}

// A triangle near the other cluster.
struct NearTriangle {
  Corners corners;
  Double3 outward;  // of unit length
  float low[3], high[3];
  std::uint32_t triangle;
};

struct NearTriangles {
  NearTriangle list[kMaxClusterTriangles];
  std::size_t count = 0;
};

class Finder final : public NearClusters {
 public:
  Finder(GapJob& job, const Memory& memory)
      : job_(job),
        memory_(memory),
        a_(memory.a),
        b_(job.are_one ? memory.a : memory.b),
        side_a_(handedness_of(job.a.pose)),
        side_b_(handedness_of(job.b.pose)),
        fold_(kFold * double{view_of(*job.a.asset).info().height}),
        margin_(static_cast<float>(job.margin)) {}

  // Each pair of one body is asked about once.
  bool asks(std::size_t sphere_a, std::size_t sphere_b) const override {
    const bool is_asked = memory_.asks[sphere_a].meets(memory_.parts[sphere_b]);
    if (!is_asked || !job_.are_one) {
      return is_asked;
    }
    const std::size_t ignored = ignored_bit(std::min(sphere_a, sphere_b), std::max(sphere_a, sphere_b));
    return sphere_a != sphere_b && (a_.ignored[ignored / 64] >> ignored % 64 & 1) == 0;
  }

  bool leaves_out(std::size_t cluster_a, std::size_t cluster_b) const override {
    return is_buried(*a_.surface, cluster_a) || is_buried(*b_.surface, cluster_b) ||
           (job_.are_one && are_layers(*a_.surface, cluster_a, cluster_b));
  }

  void add(const NearCluster& a, const NearCluster& b) override {
    if (!are_within(a.low, a.high, b.low, b.high, margin_)) {
      return;
    }
    list(*a_.surface, side_a_, a, b, near_a_);
    if (near_a_.count == 0) {
      return;
    }
    list(*b_.surface, side_b_, b, a, near_b_);
    double least = job_.margin;
    for (std::size_t i = 0; i < near_a_.count; ++i) {
      for (std::size_t j = 0; j < near_b_.count; ++j) {
        look(near_a_.list[i], near_b_.list[j], least);
      }
    }
  }

 private:
  // The triangles of `of` whose boxes come within the margin of the other cluster's box.
  void list(const Surface& surface, double side, const NearCluster& of, const NearCluster& other,
            NearTriangles& out) const {
    out.count = 0;
    const Cluster& cluster = surface.clusters[of.cluster];
    const std::uint8_t* slots = surface.corners.data + 3 * std::size_t{cluster.first_triangle};
    for (std::uint32_t t = 0; t < cluster.triangle_count; ++t, slots += 3) {
      NearTriangle& added = out.list[out.count];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float* const all = of.axes[axis];
        const float p = all[slots[0]], q = all[slots[1]], r = all[slots[2]];
        added.low[axis] = std::min({p, q, r});
        added.high[axis] = std::max({p, q, r});
      }
      if (are_within(added.low, added.high, other.low, other.high, margin_)) {
        added.triangle = cluster.first_triangle + t;
        for (std::size_t k = 0; k < 3; ++k) {
          added.corners.p[k] = {double{of.axes[0][slots[k]]}, double{of.axes[1][slots[k]]},
                                double{of.axes[2][slots[k]]}};
        }
        // A triangle without area, or a double whose twin counts, faces nothing.
        added.outward = (side * facing(surface, added.triangle)) * normal_of(added.corners);
        out.count += normalize(added.outward) ? 1 : 0;
      }
    }
  }

  static bool are_within(const float (&low)[3], const float (&high)[3], const float (&other_low)[3],
                         const float (&other_high)[3], float margin) {
    return low[0] <= other_high[0] + margin && other_low[0] <= high[0] + margin && low[1] <= other_high[1] + margin &&
           other_low[1] <= high[1] + margin && low[2] <= other_high[2] + margin && other_low[2] <= high[2] + margin;
  }

  // Are they near each other at rest, too?
  bool is_fold(const NearTriangle& a, const NearTriangle& b) const {
    const auto corner = [](const Surface& surface, std::uint32_t triangle) {
      const float* const p =
          surface.rest_positions.data + 3 * std::size_t{surface.triangle_vertices[3 * std::size_t{triangle}]};
      return Double3{double{p[0]}, double{p[1]}, double{p[2]}};
    };
    const Double3 apart = corner(*a_.surface, a.triangle) - corner(*b_.surface, b.triangle);
    return job_.are_one && dot(apart, apart) < fold_ * fold_;
  }

  // Could a corner of `of` be above the plane of `other`, and not farther than `least`?
  static bool may_face(const NearTriangle& of, const NearTriangle& other, double least) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const Double3& corner : of.corners.p) {
      const double above = dot(other.outward, corner - other.corners.p[0]);
      low = std::min(low, above);
      high = std::max(high, above);
    }
    return low < least && high > kFaces * least;
  }

  void look(const NearTriangle& a, const NearTriangle& b, double& least) {
    // Rounded, `least` may lose a gap that is as wide as the narrowest so far.
    if (!are_within(a.low, a.high, b.low, b.high, static_cast<float>(least)) ||
        !memory_.asked[a_.surface->parts[a.triangle]].has(b_.surface->parts[b.triangle]) ||
        dot(a.outward, b.outward) > kTurnsAway || !may_face(a, b, least) || !may_face(b, a, least) || is_fold(a, b)) {
      return;
    }
    const Nearest nearest = nearest_of(a.corners, b.corners);
    if (!(nearest.distance < least) || !(nearest.distance > 0)) {
      return;
    }
    const Double3 apart = (1 / nearest.distance) * (nearest.a - nearest.b);
    if (dot(apart, b.outward) >= kFaces && -dot(apart, a.outward) >= kFaces) {
      least = nearest.distance;
      keep({a_.surface->parts[a.triangle], b_.surface->parts[b.triangle], nearest.a, nearest.b, nearest.distance});
    }
  }

  // The narrowest of gaps that lie near each other stays; where there is no room, the widest goes.
  void keep(const Gap& gap) {
    Gap* const end = job_.gaps.data + job_.count;
    Gap* const near = std::find_if(job_.gaps.data, end, [&](const Gap& known) {
      return known.part == gap.part && known.other == gap.other && length(known.at - gap.at) < job_.patch;
    });
    if (near != end) {
      *near = gap.distance < near->distance ? gap : *near;
    } else if (job_.count < job_.gaps.size) {
      job_.gaps[job_.count++] = gap;
    } else if (job_.count > 0) {
      Gap* const widest =
          std::max_element(job_.gaps.data, end, [](const Gap& l, const Gap& r) { return l.distance < r.distance; });
      *widest = gap.distance < widest->distance ? gap : *widest;
    }
  }

  GapJob& job_;
  const Memory& memory_;
  const PosedClusters &a_, &b_;
  double side_a_, side_b_, fold_;
  float margin_;
  NearTriangles near_a_, near_b_;
};

}  // namespace

std::size_t gap_scratch_words(const AssetView& a, const AssetView& b) {
  return has_skin(a) && has_skin(b) ? Memory().lay_out(a, b, false, nullptr) : 0;
}

void GapJob::run() {
  const AssetView &asset_a = view_of(*a.asset), &asset_b = view_of(*b.asset);
  Surface surface_a, surface_b;
  read_skin_table(asset_a, a.skin_table, surface_a);
  read_skin_table(asset_b, b.skin_table, surface_b);
  Memory memory;
  memory.lay_out(asset_a, asset_b, are_one, scratch);
  set_pose(asset_a, surface_a, a.pose, nullptr, memory.a);
  if (!are_one) {
    set_pose(asset_b, surface_b, b.pose, nullptr, memory.b);
  }
  const std::size_t parts_of_b = asset_b.part_count();
  for (std::size_t p = 0; p < memory.asked.size; ++p) {
    memory.asked[p] = PartBits{};
    for (std::size_t q = 0; q < parts_of_b; ++q) {
      const std::size_t bit = p * parts_of_b + q;
      if ((part_pairs[bit / 64] >> bit % 64 & 1) != 0) {
        memory.asked[p].add(q);
      }
    }
  }
  join_parts(surface_a, memory.asks, [&](std::size_t part) { return memory.asked[part]; });
  join_parts(surface_b, memory.parts, [](std::size_t part) {
    PartBits own{};
    own.add(part);
    return own;
  });
  count = 0;
  Finder finder(*this, memory);
  find_near(target, memory.a, are_one ? memory.a : memory.b, static_cast<float>(margin), finder);
}

}  // namespace spherechain
