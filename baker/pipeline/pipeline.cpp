// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "mesh/error.h"
#include "segment/by_rig.h"
#include "segment/islands.h"
#include "write/write.h"

namespace spherechain::baker {
namespace {

double mean_abs_f(const Bake& bake) {
  double sum = 0;
  for (const TorsoFit& fit : bake.spheres.torso) {
    sum += f_error(fit.phi1_adjusted, bake.character.body, fit.vertices).mean_abs;
  }
  return bake.spheres.torso.empty() ? 0 : sum / static_cast<double>(bake.spheres.torso.size());
}

using Progress = std::function<void(const std::string&)>;

template <typename Run>
void stage(Bake& out, const Progress& progress, const char* name, const Run& run) {
  if (progress) progress(name);
  const auto start = std::chrono::steady_clock::now();
  run();
  out.times.push_back({name, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
}

// Whether less than half of the limbs' skin is of its limb's largest piece: then sections have gaps wherever they are.
bool is_in_shards(const Mesh& skin, const Regions& regions) {
  constexpr double kHangsTogether = 0.5;  // of the limbs' area
  const Islands islands = find_islands(skin, triangle_neighbours(skin), regions.of_skin);
  std::vector<double> largest(regions.limbs.size(), 0.0);
  double all = 0, hangs_together = 0;
  for (std::size_t i = 0; i < islands.area.size(); ++i) {
    const std::uint8_t region = regions.of_skin[islands.triangles[i][0]];
    if (region == regions.torso_region()) continue;
    all += islands.area[i];
    largest[region] = std::max(largest[region], islands.area[i]);
  }
  for (const double area : largest) hangs_together += area;
  return hangs_together < kHangsTogether * all;
}

void run_after_fit(Bake& out, const Progress& progress) {
  const BakeSettings& settings = out.settings;
  stage(out, progress, "chains", [&] {
    std::vector<LimbPlace> limbs;
    for (const Limb& limb : out.regions.limbs) {
      limbs.push_back({static_cast<std::uint8_t>(limbs.size()), limb.side, limb.along});
    }
    out.chains = build_chains(out.spheres, limbs);
  });
  stage(out, progress, "bind",
        [&] { out.binding = bind_spheres(out.character, out.regions, out.spheres, settings.bind); });
  stage(out, progress, "rig", [&] {
    if (is_biped(out.regions) && out.joints.empty()) {
      out.joints = place_joints(out.character, out.regions);
      if (out.character.rig.bones.empty()) out.rig_weights = rig_weights(out.character, out.joints);
    }
    out.body_parts = find_body_parts(out.character, out.roles, out.regions, out.joints, out.rig_weights);
    out.bones = bind_bones(out.character, out.binding, out.joints, out.rig_weights);
    out.moments = bind_moments(out.character, out.bones, out.rig_weights, out.binding);
  });
  stage(out, progress, "clusters",
        [&] { out.leaves = make_leaves(out.character, out.binding, out.bones, out.rig_weights, settings.leaves); });
  stage(out, progress, "write", [&] {
    out.asset = serialize({out.character, out.regions, out.spheres, out.chains, out.binding, out.joints, out.bones,
                           out.moments, out.leaves, to_json(settings)});
  });
}

void run_fit(Bake& out, const Progress& progress) {
  stage(out, progress, "fit", [&] { out.spheres = fit_spheres(out.character, out.regions, out.settings.fit); });
}

}  // namespace

Regions segment_character(Character& character, const Roles& roles, const SegmentSettings& settings,
                          ClosingReport& closing) {
  if (roles.limbs.empty() || character.rig.weights.empty()) return segment_closed(character, settings, closing);
  const bool whole = is_whole(character);
  if (whole && roles.kind == BodyKind::kBiped) {
    try {
      return segment(character, settings);
    } catch (const Error& error) {
      if (error.code() != ExitCode::kSegmentation) throw;
    }
  }
  if (settings.body != BodyKind::kUnknown && roles.kind != settings.body) {
    throw Error(ExitCode::kSegmentation, character.file + ": the rig's limbs are no " + body_kind_name(settings.body) +
                                             "'s (inspect --roles says what its joints are)");
  }
  if (whole) return segment_by_rig(character, roles, settings.facing);
  take_all_pieces(character);
  Regions of_pieces = segment_by_rig(character, roles, settings.facing);
  if (!is_in_shards(character.skin, of_pieces) || !wrap_body(character, closing)) return of_pieces;
  return segment_by_rig(character, roles, settings.facing);
}

Bake bake(const std::filesystem::path& input, const BakeSettings& settings, const Progress& progress) {
  Bake out;
  out.settings = settings;
  stage(out, progress, "import", [&] { out.character = import_character(input, settings.import); });
  stage(out, progress, "roles", [&] {
    out.roles = find_roles(out.character.rig, out.character.source_positions, settings.roles, settings.segment.body);
  });
  stage(out, progress, "segment",
        [&] { out.regions = segment_character(out.character, out.roles, settings.segment, out.closing); });
  if (out.closing.seconds > 0) {
    out.times.back().seconds -= out.closing.seconds;
    out.times.insert(out.times.end() - 1, {"wrap", out.closing.seconds});
  }
  run_fit(out, progress);
  run_after_fit(out, progress);
  return out;
}

Bake rebake(const Bake& bake, const BakeSettings& settings) {
  Bake out;
  out.settings = settings;
  out.character = bake.character;
  out.roles = bake.roles;
  out.regions = bake.regions;
  out.joints = bake.joints;
  out.rig_weights = bake.rig_weights;
  out.closing = bake.closing;
  if (settings.fit == bake.settings.fit) {
    out.spheres = bake.spheres;
  } else {
    run_fit(out, {});
  }
  run_after_fit(out, {});
  return out;
}

double covered_area(const Bake& bake) {
  const Mesh& mesh = bake.character.skin;
  double covered = 0, total = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const BoundSphere& sphere = bake.binding.spheres[bake.binding.sphere_of_triangle[t]];
    const double area = triangle_area(mesh, t);
    total += area;
    if ((triangle_centroid(mesh, t) - sphere.rest.center).norm() <= sphere.detect_radius) covered += area;
  }
  return covered / total;
}

OwnerDistance owner_distance(const Character& character, const Regions& regions, const Binding& binding) {
  std::vector<double> distances;
  double sum = 0;
  for (std::size_t t = 0; t < character.skin.triangles.size(); ++t) {
    const Ball& ball = binding.spheres[binding.sphere_of_triangle[t]].rest;
    distances.push_back(std::abs(signed_f(ball, triangle_centroid(character.skin, t))) / regions.frame.height);
    sum += distances.back();
  }
  std::sort(distances.begin(), distances.end());
  const auto count = static_cast<double>(distances.size());
  return {sum / count, distances[static_cast<std::size_t>(0.95 * count)], distances.back()};
}

std::vector<std::string> missed_targets(const Bake& bake) {
  const Targets& targets = bake.settings.targets;
  std::vector<std::string> missed;
  if (targets.max_spheres && bake.spheres.spheres.size() > *targets.max_spheres) {
    missed.push_back(
        fmt::format("max_spheres: {} asked, {} needed", *targets.max_spheres, bake.spheres.spheres.size()));
  }
  const double f = mean_abs_f(bake) / bake.regions.frame.height;
  if (targets.max_mean_abs_f && f > *targets.max_mean_abs_f) {
    missed.push_back(fmt::format("max_mean_abs_f: {:.4g} asked, {:.4g} reached", *targets.max_mean_abs_f, f));
  }
  const double covered = covered_area(bake);
  if (targets.min_covered_area && covered < *targets.min_covered_area) {
    missed.push_back(fmt::format("min_covered_area: {:.4g} asked, {:.4g} reached", *targets.min_covered_area, covered));
  }
  return missed;
}

}  // namespace spherechain::baker
