// SPDX-License-Identifier: MIT
// Are an asset's figures those of a body of its height? Each alone may be finite, and its answers are not: a pivot's
// weight of 1e30, a spread of 1e-30. The limits are far beyond what bodies have.
#include <algorithm>

#include "runtime/src/asset/asset_checks.h"

namespace spherechain {
namespace {

constexpr double kReach = 256;        // heights: from the frame's origin to whatever an asset has
constexpr double kHeightMost = 64;    // times the reach of the skin
constexpr double kSpreadMost = 4096;  // times a sphere's spread: its radii; and times its radius the detect radius
constexpr double kWeightMost = 16;    // of a pivot, or of a bone in a sphere's centre
constexpr double kMomentMost = 16;    // times what pivots at the ends of the skin would give
constexpr double kMatrixMost = 1e6;   // of an inverse bind matrix; its translation: times that reach
constexpr double kUnitMost = 1e12;    // metres a unit, or units a metre
constexpr std::uint64_t kTrianglesMost = 65536;  // of the source; and one for each byte of the asset

struct Vector {
  double x, y, z;
};
template <typename Vec>
Vector minus(const Vec& a, const Vector& b) {
  return {double{a.x} - b.x, double{a.y} - b.y, double{a.z} - b.z};
}
double greatest(const Vector& a) { return std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)}); }

class RangeChecker {
 public:
  RangeChecker(const AssetView& asset, Message& message)
      : asset_(asset), info_(asset.info()), skin_(asset.skin()), message_(message) {
    origin_ = {double{info_.origin.x}, double{info_.origin.y}, double{info_.origin.z}};
    limit_ = kReach * double{info_.height};
  }

  bool run(std::size_t size) {
    return check_source(size) && check_places() && check_height() && check_spheres() && check_bones() &&
           check_moments() && check_skin();
  }

 private:
  bool is_length(double value) const { return value <= limit_; }
  template <typename Vec>
  bool is_near(const Vec& place) const {
    return is_length(greatest(minus(place, origin_)));
  }
  bool too_far(const char* table, std::size_t i, const char* field) {
    return message_.wrong_at(table, i, field, "more than 256 heights away, or long");
  }

  bool check_source(std::size_t size) {
    const double unit = double{info_.metres_per_unit};
    return ((unit >= 1 / kUnitMost && unit <= kUnitMost) ||
            message_.wrong("source.metres_per_unit: %g is no unit of length", unit)) &&
           (info_.triangle_count <= kTrianglesMost + size ||
            message_.wrong("source.triangle_count: %zu, but the asset has %zu bytes", info_.triangle_count, size));
  }

  bool check_places() {
    for (std::size_t v = 0; v < skin_.positions.size / 3; ++v) {
      const float* const p = skin_.positions.data + 3 * v;
      const double distance = greatest(minus(Vec3{p[0], p[1], p[2]}, origin_));
      reach_ = std::max(reach_, distance);
      if (!is_length(distance)) {
        return too_far("skin.positions", v, "");
      }
    }
    for (std::size_t s = 0; s < asset_.spheres().size; ++s) {
      const RestSphere& sphere = asset_.spheres()[s];
      reach_ = std::max(reach_, greatest(minus(sphere.center, origin_)) + double{sphere.radius});
      if (!is_near(sphere.center)) {
        return too_far("spheres", s, ".center");
      }
    }
    return true;
  }

  bool check_height() {
    return double{info_.height} <= kHeightMost * reach_ ||
           message_.wrong("frame.height: %g is not that of a body whose skin reaches %g far", double{info_.height},
                          reach_);
  }

  bool check_spheres() {
    for (std::size_t s = 0; s < asset_.spheres().size; ++s) {
      const RestSphere& sphere = asset_.spheres()[s];
      const double radius = double{std::max(sphere.radius, sphere.detect_radius)};
      if (!is_length(radius) || !is_length(double{sphere.pivot_spread})) {
        return too_far("spheres", s, ".radius");
      }
      if (double{sphere.detect_radius} > kSpreadMost * double{sphere.radius}) {
        return message_.wrong_at("spheres", s, ".detect_radius", "far beyond the radius");
      }
      if (radius > kSpreadMost * double{sphere.pivot_spread}) {
        return message_.wrong_at("spheres", s, ".pivot_spread", "far below the radius");
      }
    }
    for (std::size_t i = 0; i < asset_.pivots().size; ++i) {
      if (!(std::abs(double{asset_.pivots()[i].weight}) <= kWeightMost)) {
        return message_.wrong_at("pivots", i, ".weight", "more than 16");
      }
    }
    return true;
  }

  bool check_bones() {
    for (std::size_t i = 0; i < asset_.joint_count(); ++i) {
      if (!is_near(asset_.joint(i).position) || !is_near(asset_.joint(i).tail)) {
        return too_far("joints", i, ".position");
      }
    }
    const double far = kMatrixMost * (limit_ + greatest(origin_));
    for (std::size_t i = 0; i < asset_.bone_count(); ++i) {
      const float* const m = asset_.bone(i).inverse_bind;
      for (std::size_t k = 0; k < 12; ++k) {
        if (!(std::abs(double{m[k]}) <= (k % 4 == 3 ? far : kMatrixMost))) {
          return message_.wrong_at("bones", i, ".inverse_bind", "no matrix of a bone of this body");
        }
      }
    }
    return true;
  }

  // A bone's share of the mean square of distances, in units of a sphere's spread: less than that of pivots as far from
  // the moments' origin as skin is. Row or column 3 stands for a share that moves with no distance.
  bool check_moments() {
    const MomentTables& tables = asset_.moment_tables();
    if (tables.moments.size == 0) {
      return true;
    }
    if (!is_near(tables.origin)) {
      return too_far("moments.origin", 0, "");
    }
    const double far = 2 * reach_;
    std::size_t moment = 0, center = 0;
    for (std::size_t i = 0; i < tables.spheres.size; ++i) {
      const std::size_t bones = tables.bone_counts[i];
      for (const std::size_t end = center + bones; center < end; ++center) {
        const CenterTerm& term = tables.centers[center];
        if (!(std::abs(double{term.w}) <= kWeightMost) || !(greatest(minus(term, {0, 0, 0})) <= kWeightMost * far)) {
          return message_.wrong_at("moments.centers", center, "too great for this body");
        }
      }
      const double spread = double{asset_.spheres()[tables.spheres[i]].pivot_spread};
      for (const std::size_t end = moment + bones * (bones + 1) / 2; moment < end; ++moment) {
        for (std::size_t k = 0; k < kMomentSize; ++k) {
          const double row = k / 4 == 3 ? 1 : far, column = k % 4 == 3 ? 1 : far;
          if (!(std::abs(double{tables.moments[moment].values[k]}) <=
                kMomentMost * (row / spread) * (column / spread))) {
            return message_.wrong_at("moments.moments", moment, "too great for this body");
          }
        }
      }
    }
    return true;
  }

  template <typename Lanes>
  bool lanes_are_near(const Lanes& lanes, const Vector& origin) const {
    for (std::size_t k = 0; k < kClusterLanes; ++k) {
      const bool is_spare = !(lanes.radius[k] > 0);
      if (!is_length(double{lanes.radius[k]}) ||
          (!is_spare && !is_length(greatest(minus(Vec3{lanes.x[k], lanes.y[k], lanes.z[k]}, origin))))) {
        return false;
      }
    }
    return true;
  }

  bool check_skin() {
    for (std::size_t i = 0; i < skin_.morphs.size; ++i) {
      if (!is_length(greatest(minus(skin_.morphs[i].delta, {0, 0, 0})))) {
        return too_far("skin.morphs", i, ".delta");
      }
    }
    for (std::size_t g = 0; g < skin_.boxes.size; ++g) {
      const BoxLanes& box = skin_.boxes[g];
      const auto is_long = [&](const float(&halves)[kClusterLanes]) {
        return !is_length(double{*std::max_element(halves, halves + kClusterLanes)});
      };
      if (!lanes_are_near(box, origin_) || is_long(box.half_x) || is_long(box.half_y) || is_long(box.half_z)) {
        return too_far("skin.boxes", g, "");
      }
    }
    for (std::size_t i = 0; i < skin_.bounds_morphs.size; ++i) {
      if (!lanes_are_near(skin_.bounds_morphs[i], {0, 0, 0})) {
        return too_far("skin.bounds_morphs", i, "");
      }
    }
    for (std::size_t i = 0; i < skin_.bounds_terms.size; ++i) {
      for (std::size_t k = 0; k < kClusterLanes; ++k) {
        if (!(skin_.bounds_terms[i].weights[k] <= 2) || !(skin_.bounds_terms[i].deviations[k] <= 2)) {
          return message_.wrong_at("skin.bounds_terms", i, "no weight");
        }
      }
    }
    for (std::size_t s = 0; s < skin_.hulls.size; ++s) {
      const PackedHull& hull = skin_.hulls[s];
      if (hull.bone_count > 0 &&
          (!is_near(hull.center) || !is_length(double{hull.radius}) || !is_length(double{hull.slack}))) {
        return too_far("skin.hulls", s, "");
      }
    }
    for (std::size_t i = 0; i < skin_.hull_bones.size; ++i) {
      const HullBone& bone = skin_.hull_bones[i];
      if (!is_length(greatest(minus(bone, {0, 0, 0}))) || !(bone.w <= 2)) {
        return too_far("skin.hull_bones", i, "");
      }
    }
    return true;
  }

  const AssetView& asset_;
  const AssetInfo info_;
  const SkinData& skin_;
  Message& message_;
  Vector origin_{};
  double limit_ = 0, reach_ = 0;  // what is far; how far the skin is from the origin
};

}  // namespace

bool figures_are_in_range(const AssetView& asset, std::size_t size, Message& message) {
  return RangeChecker(asset, message).run(size);
}

}  // namespace spherechain
