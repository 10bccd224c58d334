// SPDX-License-Identifier: GPL-3.0-or-later
#include "study.h"

#include "baker/motion/poses.h"

namespace spherechain::paper {
namespace {

std::vector<bool> core_triangles(const Bake& bake) {
  const baker::Regions& regions = bake.regions;
  const baker::Mesh& mesh = bake.regions.body.mesh;
  std::vector<bool> core;
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 centroid = triangle_centroid(mesh, t);
    const std::uint8_t region = regions.of_triangle[t];
    if (region == baker::kTorso) {
      core.push_back((centroid - regions.frame.origin).dot(regions.frame.up) <= regions.torso.neck);
    } else {
      core.push_back(regions.limbs[region].line.closest(centroid) <= regions.limbs[region].extremity);
    }
  }
  return core;
}

}  // namespace

Study::Study(const std::filesystem::path& character, const std::filesystem::path& poses, int frames)
    : paper_(baker::bake(character, baker::make_settings("paper", "{}", "paper"), {})),
      balanced_(rebake(paper_, baker::make_settings("balanced", "{}", "balanced"))),
      core_(core_triangles(paper_)) {
  const std::vector<baker::VertexWeights> weights = rig_weights(paper_.character, paper_.regions.body, paper_.joints);
  for (const std::string name : {"arms", "legs"}) {
    const baker::BezierMotion motion(paper_.joints, paper_.regions.frame,
                                     read_pose_motion(poses / ("animation_" + name + ".json"), paper_.joints));
    Animation animation{name, {}};
    for (int i = 0; i < frames; ++i) {
      const std::vector<baker::Affine> bones = motion.at(static_cast<double>(i) / (frames - 1)).bones;
      animation.frames.push_back(deform(paper_.character.source_positions, weights, bones));
    }
    animations_.push_back(std::move(animation));
  }
}

Bake Study::bake(const std::string& profile, const std::string& json) const {
  const baker::BakeSettings settings = baker::make_settings(profile, json, profile + " " + json);
  return rebake(settings.fit == balanced_.settings.fit ? balanced_ : paper_, settings);
}

}  // namespace spherechain::paper
