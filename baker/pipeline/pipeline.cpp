// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "mesh/error.h"
#include "segment/by_rig.h"
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

// A closed biped is segmented by its shape, which knows armpit and crotch best; all else by its rig, where there is
// one, or by a closed surface made for it.
void run_segment(Bake& out) {
  const bool rigged = !out.roles.limbs.empty() && !out.character.rig.weights.empty();
  const bool whole = is_whole(out.character);
  if (!rigged) {
    out.regions = segment_closed(out.character, out.settings.segment, out.closing);
    return;
  }
  if (whole && out.roles.kind == BodyKind::kBiped) {
    try {
      out.regions = segment(out.character, out.settings.segment);
      return;
    } catch (const Error& error) {
      if (error.code() != ExitCode::kSegmentation) throw;
    }
  }
  const BodyKind wanted = out.settings.segment.body;
  if (wanted != BodyKind::kUnknown && out.roles.kind != wanted) {
    throw Error(ExitCode::kSegmentation, out.character.file + ": the rig's limbs are no " + body_kind_name(wanted) +
                                             "'s (inspect --roles says what its joints are)");
  }
  if (!whole) take_all_pieces(out.character);
  out.regions = segment_by_rig(out.character, out.roles);
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
    out.bones = bind_bones(out.character, out.binding, out.joints, out.rig_weights);
  });
  stage(out, progress, "write", [&] {
    out.asset =
        serialize({out.character, out.regions, out.spheres, out.chains, out.binding, out.joints, out.bones, to_json(settings)});
  });
}

void run_fit(Bake& out, const Progress& progress) {
  stage(out, progress, "fit", [&] { out.spheres = fit_spheres(out.character, out.regions, out.settings.fit); });
}

}  // namespace

Bake bake(const std::filesystem::path& input, const BakeSettings& settings, const Progress& progress) {
  Bake out;
  out.settings = settings;
  stage(out, progress, "import", [&] { out.character = import_character(input, settings.import); });
  stage(out, progress, "roles", [&] {
    out.roles = find_roles(out.character.rig, out.character.source_positions, settings.roles, settings.segment.body);
  });
  stage(out, progress, "segment", [&] { run_segment(out); });
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
