// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/edits/hidden_contacts.h"

#include <fmt/format.h>

#include <Eigen/Core>

namespace spherechain::baker {
namespace {

constexpr double kMore = 0.02;  // smaller changes are not reported

// For each two parts, the share of pairs of places, one on each, whose triangles never meet: their spheres are
// neighbours, or one.
Eigen::MatrixXd left_out(const Character& character, const BodyParts& parts, const Binding& binding) {
  const auto part_count = static_cast<Eigen::Index>(parts.parts.size());
  Eigen::MatrixXd areas = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(binding.spheres.size()), part_count);
  for (std::size_t t = 0; t < binding.sphere_of_triangle.size(); ++t) {
    areas(binding.sphere_of_triangle[t], parts.of_triangle[character.skin_source_triangle[t]]) +=
        triangle_area(character.skin, t);
  }
  Eigen::MatrixXd out = areas.transpose() * areas;
  for (const auto& [a, b] : binding.ignored) {
    const Eigen::MatrixXd both = areas.row(a).transpose() * areas.row(b);
    out += both + both.transpose();
  }
  const Eigen::VectorXd whole = areas.colwise().sum();
  return (out.array() / (whole * whole.transpose()).array().max(1e-300)).matrix();
}

}  // namespace

std::vector<std::string> hidden_contacts(const Character& character, const BodyParts& parts, const Binding& before,
                                         const Binding& after) {
  const Eigen::MatrixXd was = left_out(character, parts, before), is = left_out(character, parts, after);
  std::vector<std::string> out;
  for (Eigen::Index a = 0; a < is.rows(); ++a) {
    for (Eigen::Index b = a + 1; b < is.rows(); ++b) {
      if (is(a, b) <= was(a, b) + kMore) continue;
      const auto name = [&](Eigen::Index i) { return parts.parts[static_cast<std::size_t>(i)].name; };
      out.push_back(fmt::format(
          "{} and {}: contacts between neighbouring spheres are left out: {:.0f} % of the two skins, before {:.0f} %",
          name(a), name(b), 100 * is(a, b), 100 * was(a, b)));
    }
  }
  return out;
}

}  // namespace spherechain::baker
