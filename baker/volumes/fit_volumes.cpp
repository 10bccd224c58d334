// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/volumes/fit_volumes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>

#include "baker/volumes/bodies.h"
#include "baker/volumes/fit_body.h"

namespace spherechain::baker {
namespace {

constexpr int kSamplesOfBody = 200;
constexpr double kSmallPart = 0.004;  // of the skin's area: stands for no part of its own
constexpr int kVolumesOfBodyMax = 12;
constexpr double kGainMin = 0.03;  // of the skin's gap: what a further volume has to save
constexpr double kBend = 0.8;      // how far a point goes when its joint turns by some 60 degrees, of its distance
constexpr double kLimb = 0.75;     // what hangs on a joint that bends: this power of the number of bodies
constexpr double kAlike = 0.5;     // of what it costs: a merge that was done on the other side

// How far a body's volumes may reach along each direction: to its own samples, and up to half their thickness beyond
// if samples of connected bodies reach that far.
std::vector<double> reach_of(const std::vector<BodySample>& own, const std::vector<Vec3>& beside) {
  std::vector<double> out;
  for (const Vec3& direction : reach_directions()) {
    double low = INFINITY, high = -INFINITY, all = -INFINITY;
    for (const BodySample& sample : own) {
      low = std::min(low, direction.dot(sample.point));
      high = std::max(high, direction.dot(sample.point));
    }
    for (const Vec3& point : beside) all = std::max(all, direction.dot(point));
    out.push_back(std::clamp(all, high, high + (high - low) / 2));
  }
  return out;
}

// The bodies' skins and what is fitted to them so far.
class VolumeSets {
 public:
  VolumeSets(const Colliders& colliders, const std::vector<SkinSample>& skin, VolumeShape shape)
      : colliders_(colliders), skin_(skin), shape_(shape), holder_(colliders.bodies.size()) {
    for (std::size_t i = 0; i < holder_.size(); ++i) holder_[i] = i;
    std::map<std::string, std::size_t> by_name;
    for (std::size_t i = 0; i < holder_.size(); ++i) by_name[colliders.bodies[i].name] = i;
    for (const auto& [name, left] : by_name) {
      if (!name.starts_with("left ")) continue;
      const auto right = by_name.find("right " + name.substr(5));
      if (right == by_name.end()) continue;
      other_side_[left] = right->second;
      other_side_[right->second] = left;
    }
    for (const SkinSample& sample : skin) alive_[static_cast<std::size_t>(sample.body)] = true;
    for (std::size_t i = 0; i < holder_.size(); ++i) {
      if (alive_[i]) begin(i);
    }
  }

  int count() const {
    int out = 0;
    for (std::size_t i = 0; i < fits_.size(); ++i) out += alive_[i] ? size_of(taken(i)) : 0;
    return out;
  }
  double gap() const {
    double out = 0;
    for (std::size_t i = 0; i < fits_.size(); ++i) out += alive_[i] ? taken(i).gap : 0;
    return out;
  }

  // Bodies of less area than this go to the one that they hang on.
  void merge_smaller(double area) {
    for (std::size_t i = skins_.size(); i-- > 0;) {
      if (!alive_[i] || area_of(i) >= area || !parent_of(i)) continue;
      merge(i);
    }
  }

  // The merge that costs least. False where no body hangs on another.
  bool merge_cheapest() {
    std::size_t best = skins_.size();
    double least = INFINITY;
    for (std::size_t i = 0; i < skins_.size(); ++i) {
      if (!alive_[i] || !parent_of(i)) continue;
      const std::size_t parent = *parent_of(i);
      if (!merged_.contains({i, parent})) merged_[{i, parent}] = fit_body(shape_, skin_of(parent, i), 1).gap;
      const double more = merged_[{i, parent}] - taken(i).gap - taken(parent).gap;
      double cost = std::max(more, 0.0) + bend_of(i, parent);
      if (other_side_[i] && !alive_[*other_side_[i]]) cost *= kAlike;
      if (cost < least) {
        least = cost;
        best = i;
      }
    }
    if (best == skins_.size()) return false;
    merge(best);
    return true;
  }

  // Adds volumes to the body where one more saves most; two at once where one alone saves nothing. False where none
  // saves at least `gain`, or no more than `room` fit.
  bool split_best(double gain, int room) {
    std::size_t best = skins_.size(), best_more = 0;
    double most = gain;
    for (std::size_t i = 0; i < skins_.size(); ++i) {
      if (!alive_[i]) continue;
      for (std::size_t more = 1; more <= 2 && static_cast<int>(more) <= room; ++more) {
        const BodyFit* next = fit_of(i, taken_[i] + more);
        if (next == nullptr) break;
        const double saved = (taken(i).gap - next->gap) / static_cast<double>(more);
        if (saved > most) {
          most = saved;
          best = i;
          best_more = more;
        }
      }
    }
    if (best == skins_.size()) return false;
    taken_[best] += best_more;
    return true;
  }

  // The body that it was merged with; -1: none.
  int held_by(std::size_t body) const { return holder_[body] == body ? -1 : static_cast<int>(holder_[body]); }

  std::vector<Volume> volumes_of(std::size_t body) const {
    return alive_[body] ? taken(body).volumes : std::vector<Volume>();
  }

 private:
  static int size_of(const BodyFit& fit) { return static_cast<int>(fit.volumes.size()); }
  const BodyFit& taken(std::size_t i) const { return fits_[i][taken_[i]]; }

  double area_of(std::size_t i) const {
    double area = 0;
    for (const BodySample& sample : skins_[i].samples) area += sample.area;
    return area;
  }

  // With that many volumes more than one; null where a body has no more.
  const BodyFit* fit_of(std::size_t i, std::size_t more) {
    if (more >= kVolumesOfBodyMax || skins_[i].samples.size() < 8 * (more + 1)) return nullptr;
    while (fits_[i].size() <= more)
      fits_[i].push_back(fit_body(shape_, skins_[i], static_cast<int>(fits_[i].size()) + 1));
    return &fits_[i][more];
  }

  // The nearest body above that has samples.
  std::optional<std::size_t> parent_of(std::size_t i) const {
    int at = colliders_.bodies[i].parent;
    while (at >= 0 && !alive_[static_cast<std::size_t>(at)])
      at = colliders_.bodies[static_cast<std::size_t>(at)].parent;
    if (at < 0) return std::nullopt;
    return static_cast<std::size_t>(at);
  }

  // The gap that a body's skin adds when its joint bends and the volumes of another body replace it. The middle of a
  // limb counts more than its end, because all that hangs on it leaves the limb's volumes, too. So neck, shoulders,
  // hands and feet go before heads and arms.
  double bend_of(std::size_t i, std::size_t holder) const {
    const int bone = colliders_.bodies[i].bone_index;
    if (bone < 0 || bone == colliders_.bodies[holder].bone_index) return 0;
    double farthest = 0;
    for (const BodySample& sample : skins_[i].samples) farthest = std::max(farthest, sample.point.norm());
    int limb = 0;
    for (std::size_t k = 0; k < holder_.size(); ++k) {
      std::optional<std::size_t> at = k;
      while (at && *at != i) at = parent_of(*at);
      limb += alive_[k] && at ? 1 : 0;
    }
    return kBend * farthest * area_of(i) * std::pow(limb, kLimb);
  }

  bool hang_together(std::size_t i, std::size_t k) const {
    return colliders_.bodies[i].parent == static_cast<int>(k) || colliders_.bodies[k].parent == static_cast<int>(i);
  }

  // In its frame: the skin of all that it holds, and of one body more.
  BodySkin skin_of(std::size_t body, std::size_t more) const {
    const auto is_in = [&](std::size_t one) { return holder_[one] == body || holder_[one] == more; };
    std::vector<bool> is_beside(holder_.size(), false);
    for (std::size_t i = 0; i < holder_.size(); ++i) {
      for (std::size_t k = 0; k < holder_.size(); ++k) is_beside[k] = is_beside[k] || (is_in(i) && hang_together(i, k));
    }
    const Eigen::Isometry3d to_body = colliders_.bodies[body].rest.inverse(Eigen::Isometry);
    BodySkin out;
    std::vector<Vec3> beside;
    for (const SkinSample& sample : skin_) {
      const auto of = static_cast<std::size_t>(sample.body);
      if (is_in(of)) {
        out.samples.push_back({to_body * sample.point, sample.area});
      } else if (is_beside[of]) {
        beside.push_back(to_body * sample.point);
      }
    }
    out.reach = reach_of(out.samples, beside);
    return out;
  }

  void begin(std::size_t i) {
    skins_[i] = skin_of(i, i);
    fits_[i] = {fit_body(shape_, skins_[i], 1)};
    taken_[i] = 0;
  }

  void merge(std::size_t i) {
    const std::size_t parent = *parent_of(i);
    for (std::size_t& holder : holder_) holder = holder == i ? parent : holder;
    begin(parent);
    alive_[i] = false;
    std::erase_if(merged_, [&](const auto& entry) {
      const auto& [pair, gap] = entry;
      return pair.first == i || pair.second == i || pair.first == parent || pair.second == parent;
    });
  }

  const Colliders& colliders_;
  const std::vector<SkinSample>& skin_;
  VolumeShape shape_;
  std::vector<std::size_t> holder_;  // of each body: the one whose volumes stand for it
  std::vector<std::optional<std::size_t>> other_side_ =
      std::vector<std::optional<std::size_t>>(holder_.size());          // of a left body the right one, and back
  std::vector<bool> alive_ = std::vector<bool>(holder_.size(), false);  // has volumes
  std::vector<BodySkin> skins_ = std::vector<BodySkin>(holder_.size());
  std::vector<std::vector<BodyFit>> fits_ =
      std::vector<std::vector<BodyFit>>(holder_.size());  // with one volume, two ...
  std::vector<std::size_t> taken_ = std::vector<std::size_t>(holder_.size(), 0);
  std::map<std::pair<std::size_t, std::size_t>, double> merged_;  // the gap of two bodies with one volume
};

}  // namespace

VolumeShape volume_shape(const std::string& name) {
  return static_cast<VolumeShape>(std::find(std::begin(kVolumeShapes), std::end(kVolumeShapes), name) -
                                  std::begin(kVolumeShapes));
}

Colliders fit_volumes(const OpenAsset& asset, VolumeShape shape, int at_most) {
  Colliders out = find_bodies(asset);
  const std::vector<SkinSample> skin = sample_skin(asset, out, skin_positions(asset), kSamplesOfBody);
  double area = 0;
  for (const SkinSample& sample : skin) area += sample.area;
  VolumeSets sets(out, skin, shape);
  sets.merge_smaller(kSmallPart * area);
  // Spheres are cheap to test and poor to fit: as many as the asset has.
  if (shape == VolumeShape::kSpheres && at_most == 0) {
    at_most = std::max(sets.count(), static_cast<int>(asset->info().sphere_count));
  }
  while (at_most > 0 && sets.count() > at_most && sets.merge_cheapest()) {
  }
  const double gain = at_most > 0 ? 1e-3 * sets.gap() : kGainMin * sets.gap();
  const auto room = [&] { return at_most > 0 ? at_most - sets.count() : kVolumesOfBodyMax; };
  while (room() > 0 && sets.split_best(gain, room())) {
  }
  for (std::size_t i = 0; i < out.bodies.size(); ++i) out.bodies[i].volumes = sets.volumes_of(i);
  for (std::size_t i = 0; i < out.bodies.size(); ++i) out.bodies[i].held_by = sets.held_by(i);
  ignore_by_rest(out);
  return out;
}

}  // namespace spherechain::baker
