// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mask/raised_limbs.h"

#include <algorithm>
#include <array>
#include <optional>

#include "baker/motion/clip.h"
#include "baker/motion/frame_times.h"
#include "baker/roles/roles.h"

namespace spherechain::baker {
namespace {

constexpr double kLimbFps = 10;     // enough to see a limb go up
constexpr double kArmRaised = 0.0;  // cosine between the limb and the trunk's up
constexpr double kLegRaised = -0.5;

struct LimbKind {
  const char* name;
  std::array<const char*, 2> upper, middle;
  double raised;
};
constexpr std::array<LimbKind, 2> kKinds{
    {{"arms", {"left_shoulder", "right_shoulder"}, {"left_elbow", "right_elbow"}, kArmRaised},
     {"legs", {"left_hip", "right_hip"}, {"left_knee", "right_knee"}, kLegRaised}}};

std::optional<std::size_t> node_of(const Roles& roles, const std::string& role) {
  const auto found =
      std::find_if(roles.of_node.begin(), roles.of_node.end(), [&](const NodeRole& node) { return node.role == role; });
  if (found == roles.of_node.end()) return std::nullopt;
  return static_cast<std::size_t>(found - roles.of_node.begin());
}

}  // namespace

std::vector<std::string> limbs_never_raised(const Character& character, const std::vector<Clip>& clips) {
  const Roles roles = find_roles(character.rig, character.source_positions);
  const auto pelvis = node_of(roles, "pelvis"), neck = node_of(roles, "neck");
  if (roles.kind != BodyKind::kBiped || !pelvis || !neck) return {};
  std::array<bool, 2> is_raised{};
  for (const Clip& clip : clips) {
    const int count = frames_in(clip.duration, kLimbFps);
    for (int f = 0; f < count; ++f) {
      const std::vector<Affine> world = world_at(character.rig, clip, f / kLimbFps);
      const auto direction = [&](std::size_t from, std::size_t to) {
        return Vec3(world[to].translation() - world[from].translation()).normalized();
      };
      const Vec3 trunk = direction(*pelvis, *neck);
      for (std::size_t k = 0; k < kKinds.size(); ++k) {
        for (std::size_t side = 0; side < 2; ++side) {
          const auto upper = node_of(roles, kKinds[k].upper[side]), middle = node_of(roles, kKinds[k].middle[side]);
          if (!upper || !middle || direction(*upper, *middle).dot(trunk) > kKinds[k].raised) is_raised[k] = true;
        }
      }
    }
  }
  std::vector<std::string> out;
  for (std::size_t k = 0; k < kKinds.size(); ++k) {
    if (!is_raised[k]) out.push_back(kKinds[k].name);
  }
  return out;
}

}  // namespace spherechain::baker
