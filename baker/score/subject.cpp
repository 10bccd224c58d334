// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/score/subject.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "baker/bind/part_names.h"

namespace spherechain::baker {
namespace {

std::optional<ScoredLimb> limb_of(std::string_view part, std::string_view arm, std::string_view leg) {
  const bool is_left = part.starts_with("left ");
  if (!is_left && !part.starts_with("right ")) return {};
  part.remove_prefix(part.find(' ') + 1);
  if (arm.find("," + std::string(part) + ",") != std::string_view::npos)
    return is_left ? ScoredLimb::kLeftArm : ScoredLimb::kRightArm;
  if (leg.find("," + std::string(part) + ",") != std::string_view::npos)
    return is_left ? ScoredLimb::kLeftLeg : ScoredLimb::kRightLeg;
  return {};
}

VertexPlace place_of(std::string_view part) {
  if (const auto limb = limb_of(part, ",upper arm,forearm,hand,", ",shin,foot,"))
    return {true, false, part.ends_with(" hand") || part.ends_with(" foot"), *limb};
  if (const auto limb = limb_of(part, ",shoulder,", ",thigh,")) return {false, true, false, *limb};
  return {};
}

// By bone: the name of the body part that it moves.
std::vector<std::string> part_names(const AnimatedAsset& animated) {
  std::vector<std::string> out;
  const SourceRig& rig = animated.character().rig;
  if (rig.bones.empty()) {
    for (const std::string& joint : animated.bone_names()) out.push_back(name_part(joint).name);
    return out;
  }
  const std::vector<PartName> of_node = name_parts(rig, animated.roles());
  for (const Bone& bone : rig.bones) out.push_back(of_node[bone.node].name);
  return out;
}

std::vector<Vec3> normals_of(const ScoredSkin& skin) {
  std::vector<Vec3> out(skin.rest.size(), Vec3::Zero());
  for (const Triangle& t : skin.triangles) {
    const Vec3& a = skin.rest[t[0]];
    const Vec3 area = (skin.rest[t[1]] - a).cross(skin.rest[t[2]] - a);
    for (const Index v : t) out[skin.joined[v]] += area;
  }
  for (Index v = 0; v < out.size(); ++v) out[v] = skin.joined[v] == v ? out[v].stableNormalized() : out[skin.joined[v]];
  return out;
}

}  // namespace

ScoreSubject score_subject(const AnimatedAsset& animated) {
  const Character& character = animated.character();
  const BodyFrame frame = animated.frame();
  ScoreSubject out{animated,     BoneJoints(animated),
                   frame.height, mm_per_unit(animated.asset()),
                   frame,        scored_skin(character.source_positions, character.source_triangles),
                   {},           {},
                   false};
  out.normals = normals_of(out.skin);
  const std::vector<std::string> names = part_names(animated);
  std::array<std::size_t, kLimbs> counts{};
  for (std::size_t v = 0; v < animated.weights().size(); ++v) {
    const VertexWeights& weights = animated.weights()[v];
    if (weights.weight[0] <= 0) continue;
    out.skin.places[v] = place_of(names[weights.joint[0]]);
    if (out.skin.places[v].is_on_limb) ++counts[static_cast<std::size_t>(out.skin.places[v].limb)];
  }
  out.has_limbs = std::find(counts.begin(), counts.end(), 0U) == counts.end();
  const OpenAsset& asset = animated.asset();
  for (std::uint32_t part = 0; part < asset->part_count(); ++part) {
    const std::string_view name = asset.model().part_name(part);
    const std::int32_t bone = asset.model().part(part).bone;
    if (bone >= 0 && (name.ends_with(" hand") || name.ends_with(" foot")))
      out.ends[name.ends_with(" foot") ? 1 : 0].push_back(static_cast<std::size_t>(bone));
  }
  return out;
}

std::vector<Vec3> posed_normals(const ScoreSubject& subject, const Deformation& deformation) {
  std::vector<Vec3> out = subject.normals;
  if (deformation.bones.empty()) return out;
  const std::vector<VertexWeights>& weights = subject.animated.weights();
  for (std::size_t v = 0; v < out.size(); ++v) {
    Vec3 turned = Vec3::Zero();
    for (std::size_t k = 0; k < kMaxInfluences && weights[v].weight[k] > 0; ++k)
      turned += weights[v].weight[k] * (deformation.bones[weights[v].joint[k]].linear() * out[v]);
    if (weights[v].weight[0] > 0) out[v] = turned.stableNormalized();
  }
  return out;
}

}  // namespace spherechain::baker
