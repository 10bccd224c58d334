// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/export/for_engines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "baker/export/simple_volumes.h"
#include "baker/mesh/decompose.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

// Replaces every volume of kind T. `what` goes into the note, after the count.
template <class T, class Replace>
void replace_volumes(Colliders& colliders, const Replace& replace, const char* what, std::vector<std::string>& notes) {
  int count = 0;
  double farthest = 0;
  for (ColliderBody& body : colliders.bodies) {
    for (Volume& volume : body.volumes) {
      const T* old = std::get_if<T>(&volume);
      if (old == nullptr || std::string(volume_name(volume)) == "capsule") continue;
      const Volume made = replace(*old);
      farthest = std::max(farthest, surface_distance(volume, made));
      volume = made;
      ++count;
    }
  }
  if (count > 0) {
    notes.push_back(fmt::format("{} {}; their surface moves by at most {:.1f} mm", count, what, 1000 * farthest));
  }
}

// Keeps the bodies for which `new_place` is not negative, at that place. Bodies that share a place are joined.
void renumber(Colliders& colliders, const std::vector<int>& new_place) {
  std::vector<ColliderBody> bodies;
  for (std::size_t i = 0; i < new_place.size(); ++i) {
    if (new_place[i] < 0) continue;
    ColliderBody& body = colliders.bodies[i];
    if (static_cast<std::size_t>(new_place[i]) == bodies.size()) {
      int parent = body.parent;  // the nearest that stays
      while (parent >= 0 && new_place[static_cast<std::size_t>(parent)] < 0) {
        parent = colliders.bodies[static_cast<std::size_t>(parent)].parent;
      }
      bodies.push_back(std::move(body));
      bodies.back().parent = parent < 0 ? -1 : new_place[static_cast<std::size_t>(parent)];
    } else {
      std::vector<Volume>& volumes = bodies[static_cast<std::size_t>(new_place[i])].volumes;
      volumes.insert(volumes.end(), body.volumes.begin(), body.volumes.end());
    }
  }
  std::map<std::pair<int, int>, std::pair<int, IgnoredReason>>
      found;  // how many of their pairs, and the first's reason
  for (const IgnoredBodies& pair : colliders.ignored) {
    const int a = new_place[static_cast<std::size_t>(pair.a)], b = new_place[static_cast<std::size_t>(pair.b)];
    if (a < 0 || b < 0 || a == b) continue;
    ++found.try_emplace({std::min(a, b), std::max(a, b)}, 0, pair.reason).first->second.first;
  }
  colliders.ignored.clear();
  for (const auto& [pair, count_and_reason] : found) {
    const auto joined = [&](int body) { return std::count(new_place.begin(), new_place.end(), body); };
    if (count_and_reason.first == joined(pair.first) * joined(pair.second)) {
      colliders.ignored.push_back({pair.first, pair.second, count_and_reason.second});
    }
  }
  colliders.bodies = std::move(bodies);
}

}  // namespace

void use_balls(Colliders& colliders) {
  for (ColliderBody& body : colliders.bodies) {
    for (Volume& volume : body.volumes) volume = without_inner_ball(volume);
  }
}

void use_capsules_for_cones(Colliders& colliders, std::vector<std::string>& notes) {
  const auto capsule = [](const ConeVolume& cone) {
    const double radius = (cone.radius_a + cone.radius_b) / 2;
    return ConeVolume{cone.a, cone.b, radius, radius};
  };
  replace_volumes<ConeVolume>(colliders, capsule, "cones are capsules of their mean radius", notes);
}

void use_capsules_for_ellipsoids(Colliders& colliders, std::vector<std::string>& notes) {
  const auto capsule = [](const EllipsoidVolume& ellipsoid) {
    Eigen::Index longest = 0;
    const double half = ellipsoid.radii.maxCoeff(&longest);
    const double radius = (ellipsoid.radii.sum() - half) / 2;
    const Vec3 along = ellipsoid.rotation * (Vec3::Unit(longest) * std::max(half - radius, 0.0));
    return ConeVolume{ellipsoid.center - along, ellipsoid.center + along, radius, radius};
  };
  replace_volumes<EllipsoidVolume>(colliders, capsule, "ellipsoids are capsules along their longest axis", notes);
}

void keep_bodies_on_bones(Colliders& colliders, std::vector<std::string>& notes) {
  std::vector<int> new_place;
  std::string without_bone;
  int kept = 0;
  for (const ColliderBody& body : colliders.bodies) {
    const bool is_kept = !body.bone.empty() && !body.volumes.empty();
    if (body.bone.empty() && !body.volumes.empty()) without_bone += (without_bone.empty() ? "" : ", ") + body.name;
    new_place.push_back(is_kept ? kept++ : -1);
  }
  if (kept == 0) {
    throw Error(ExitCode::kFile, colliders.source_file +
                                     ": no body part follows a bone, and this format attaches "
                                     "colliders to bones (rig the character, or export usd)");
  }
  if (!without_bone.empty()) notes.push_back("no bone moves, and the file leaves out: " + without_bone);
  renumber(colliders, new_place);
}

void join_bodies_of_a_bone(Colliders& colliders, std::vector<std::string>& notes) {
  std::map<std::string, int> place_of_bone;
  std::vector<int> new_place;
  std::string joined;
  for (const ColliderBody& body : colliders.bodies) {
    const auto [place, is_new] = place_of_bone.try_emplace(body.bone, static_cast<int>(place_of_bone.size()));
    if (!is_new) joined += (joined.empty() ? "" : ", ") + body.name;
    new_place.push_back(place->second);
  }
  if (joined.empty()) return;
  notes.push_back("a bone has one body; joined to the first of their bone: " + joined);
  renumber(colliders, new_place);
}

Eigen::Quaterniond turn_to(int axis, const Vec3& direction) {
  if (direction.norm() <= 0) return Eigen::Quaterniond::Identity();
  return turn_between(Vec3::Unit(axis), direction);
}

}  // namespace spherechain::baker
