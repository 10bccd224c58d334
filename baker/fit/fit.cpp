// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fit/fit.h"

#include <algorithm>
#include <cmath>

namespace spherechain::baker {
namespace {

// A trunk deeper than wide: the spheres of a level all but coincide.
bool is_narrow(const Spheres& torso) {
  constexpr double kCoincide = 0.8;
  double sum = 0;
  int count = 0;
  for (std::size_t i = 1; i < torso.spheres.size(); ++i) {
    const FittedSphere &a = torso.spheres[i - 1], &b = torso.spheres[i];
    if (a.level != b.level) continue;
    sum += penetration_depth(a.ball, b.ball);
    ++count;
  }
  return count > 0 && sum > kCoincide * count;
}

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> find_links(const Spheres& spheres, const Regions& regions) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  const std::vector<std::uint32_t>& torso = spheres.of_region[spheres.torso_region()];
  const auto level = [&](std::uint32_t i) { return spheres.spheres[i].level; };
  for (const std::uint32_t a : torso) {
    for (const std::uint32_t b : torso) {
      if (a < b && level(b) - level(a) <= 1) links.emplace_back(a, b);
    }
  }
  for (std::uint8_t region = 0; region < regions.limbs.size(); ++region) {
    const std::vector<std::uint32_t>& limb = spheres.of_region[region];
    for (std::size_t i = 1; i < limb.size(); ++i) links.emplace_back(limb[i - 1], limb[i]);
    const Limb& place = regions.limbs[region];
    for (const std::uint32_t i : torso) {
      if (level(i) == spheres.level_at(place.along) && !opposite(spheres.spheres[i].side, place.side)) {
        links.emplace_back(i, limb.front());
      }
    }
  }
  std::sort(links.begin(), links.end());
  return links;
}

int Spheres::level_at(double along) const {
  return static_cast<int>(std::lround(along * (static_cast<double>(level_heights.size()) - 1)));
}

std::uint32_t nearest_sphere(const Spheres& spheres, const std::vector<std::uint32_t>& among, const Vec3& point) {
  const auto distance = [&](std::uint32_t i) { return (spheres.spheres[i].ball.center - point).squaredNorm(); };
  return *std::min_element(among.begin(), among.end(),
                           [&](std::uint32_t a, std::uint32_t b) { return distance(a) < distance(b); });
}

double signed_f(const Ball& ball, const Vec3& vertex) { return ball.radius - (ball.center - vertex).norm(); }

FError f_error(const Ball& ball, const Mesh& mesh, const std::vector<Index>& vertices) {
  FError error;
  for (const Index v : vertices) {
    const double f = std::abs(signed_f(ball, mesh.positions[v]));
    error.mean_abs += f;
    error.max_abs = std::max(error.max_abs, f);
  }
  if (!vertices.empty()) error.mean_abs /= static_cast<double>(vertices.size());
  return error;
}

double penetration_depth(const Ball& a, const Ball& b) {
  return 1 - (a.center - b.center).norm() / (a.radius + b.radius);
}

Attempt<Spheres> fit_spheres(const Regions& regions, const FitSettings& settings) {
  const Mesh& mesh = regions.body.mesh;
  Spheres out;
  const auto append = [&](const std::vector<FittedSphere>& spheres) {
    out.spheres.insert(out.spheres.end(), spheres.begin(), spheres.end());
  };
  if (regions.has_torso) {
    if (auto reason = fit_torso(mesh, regions, settings, out)) return *reason;
    if (!is_biped(regions) && is_narrow(out)) {
      FitSettings one = settings;
      one.spheres_per_level = 1;
      out = {};
      if (auto reason = fit_torso(mesh, regions, one, out)) return *reason;
    }
  }
  if (regions.has_torso && settings.extremities) append(fit_head(mesh, regions, out, settings));
  const SurfaceQuery body(mesh);
  for (std::uint8_t region = 0; region < regions.limbs.size(); ++region) {
    const Attempt<std::vector<FittedSphere>> limb = fit_limb(mesh, body, regions, region, settings);
    if (!limb) return limb.reason();
    append(*limb);
    if (settings.extremities) append(fit_hand_or_foot(mesh, regions, region, out.spheres.back().ball, settings));
  }
  out.of_region.resize(regions.limbs.size() + 1);
  for (std::uint32_t i = 0; i < out.spheres.size(); ++i) out.of_region[out.spheres[i].region].push_back(i);
  out.links = find_links(out, regions);
  return out;
}

}  // namespace spherechain::baker
