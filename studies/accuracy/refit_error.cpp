// SPDX-License-Identifier: GPL-3.0-or-later
#include "refit_error.h"

#include <Eigen/Dense>
#include <cmath>

namespace spherechain::baker {

SkinFollower::SkinFollower(const Ball& rest, const std::vector<Vec3>& rest_positions,
                           const std::vector<Index>& vertices)
    : rest_(rest), vertices_(vertices) {
  for (const Index v : vertices) {
    rest_vertices_.push_back(rest_positions[v]);
    rest_f_.push_back(signed_f(rest, rest_positions[v]));
  }
}

Ball SkinFollower::at(const std::vector<Vec3>& positions) const {
  Ball ball = rest_;
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    ball.center += (positions[vertices_[i]] - rest_vertices_[i]) / static_cast<double>(vertices_.size());
  }
  for (int pass = 0; pass < 30; ++pass) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      const Vec3 d = ball.center - positions[vertices_[i]];
      const double residual = ball.radius - d.norm() - rest_f_[i];
      Eigen::Vector4d row;
      row << -d / d.norm(), 1;
      normal += row * row.transpose();
      gradient += row * residual;
    }
    const Eigen::Vector4d step = normal.ldlt().solve(-gradient);
    ball.center += step.head<3>();
    ball.radius += step[3];
    if (step.norm() < 1e-10) break;
  }
  return ball;
}

std::vector<SkinFollower> skin_followers(const Bake& bake) {
  const Character& character = bake.character;
  std::vector<Index> source_of_skin(character.skin.positions.size(), 0);
  for (Index v = 0; v < character.skin_of_source.size(); ++v) {
    if (character.skin_of_source[v] != kNoIndex) source_of_skin[character.skin_of_source[v]] = v;
  }
  const std::size_t count = bake.spheres.spheres.size();
  std::vector<std::vector<Index>> vertices(count);
  std::vector<std::vector<bool>> taken(count, std::vector<bool>(character.source_positions.size(), false));
  for (std::size_t t = 0; t < character.skin.triangles.size(); ++t) {
    const std::uint32_t s = bake.binding.sphere_of_triangle[t];
    const Ball& ball = bake.spheres.spheres[s].ball;
    for (const Index corner : character.skin.triangles[t]) {
      const Index v = source_of_skin[corner];
      if (taken[s][v] || std::abs(signed_f(ball, character.source_positions[v])) >= 0.5 * ball.radius) continue;
      taken[s][v] = true;
      vertices[s].push_back(v);
    }
  }
  std::vector<SkinFollower> followers;
  for (std::size_t s = 0; s < count; ++s) {
    followers.emplace_back(bake.spheres.spheres[s].ball, character.source_positions, vertices[s]);
  }
  return followers;
}

}  // namespace spherechain::baker
