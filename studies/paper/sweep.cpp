// SPDX-License-Identifier: GPL-3.0-or-later
// The cost and effect of each setting, over a range of it.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "baker/play/player.h"
#include "experiments.h"
#include "refit_error.h"
#include "run_frames.h"
#include "statistics.h"

namespace spherechain::paper {
namespace {

using baker::Ball;
using baker::Side;

struct Column {
  std::string name;
  Cell value;
};
using Columns = std::vector<Column>;

// The paper's count: what stands in its chains, and what brute force compares.
Columns count(const Bake& bake) {
  const std::size_t m = bake.spheres.spheres.size();
  std::size_t limbs = 0, sides = 0, middles = 0, head = 0, top = 0, bottom = 0, full_m1 = 0;
  const int top_level = static_cast<int>(bake.spheres.level_heights.size()) - 1;
  for (const baker::FittedSphere& s : bake.spheres.spheres) {
    const bool torso = s.region == baker::kTorso && !s.extremity;
    limbs += s.region != baker::kTorso ? 1 : 0;
    head += s.region == baker::kTorso && s.extremity ? 1 : 0;
    sides += torso && s.side != Side::kNone ? 1 : 0;
    middles += torso && s.side == Side::kNone ? 1 : 0;
    top += torso && s.level == top_level ? 1 : 0;
    bottom += torso && s.level == 0 ? 1 : 0;
  }
  std::vector<bool> in_chain(m, false);
  for (const baker::Chain& chain : bake.chains.chains) {
    full_m1 += chain.spheres.size() * chain.spheres.size();
    for (const std::uint32_t i : chain.spheres) in_chain[i] = true;
  }
  return {{"spheres", m},
          {"limb_spheres", limbs},
          {"torso_side_spheres", sides},
          {"torso_middle_spheres", middles},
          {"head_spheres", head},
          {"top_spheres", top},
          {"bottom_spheres", bottom},
          {"in_no_chain", std::count(in_chain.begin(), in_chain.end(), false)},
          {"chain_entries", bake.chains.entries()},
          {"chain_entries_table1", bake.chains.entries_table1},
          {"ignored_pairs", bake.binding.ignored.size()},
          {"full_tests_m1", full_m1},
          {"full_tests_m2", m * m}};
}

// |F| over the vertices of the torso's bands, and over every vertex of the surrounding regions the paper covers.
Columns fit_error(const Study& study, const Bake& bake) {
  const baker::Mesh& mesh = bake.regions.body.mesh;
  std::vector<double> torso, core;
  for (std::size_t s = 0; s < bake.spheres.torso.size(); ++s) {
    const Ball& ball = bake.spheres.spheres[s].ball;
    for (const Index v : bake.spheres.torso[s].vertices) {
      torso.push_back(study.mm() * std::abs(signed_f(ball, mesh.positions[v])));
    }
  }
  std::vector<std::uint32_t> last_owner(mesh.positions.size(), baker::kNoIndex);
  const std::vector<Index>& skin = bake.character.skin_source_triangle;  // ascending, as the body's are
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    const auto at = std::lower_bound(skin.begin(), skin.end(), bake.regions.body.source_triangle[t]) - skin.begin();
    const std::uint32_t s = bake.binding.sphere_of_triangle[static_cast<std::size_t>(at)];
    for (const Index v : mesh.triangles[t]) {
      if (!study.core()[t] || last_owner[v] == s) continue;
      last_owner[v] = s;
      core.push_back(study.mm() * std::abs(signed_f(bake.spheres.spheres[s].ball, mesh.positions[v])));
    }
  }
  return {{"torso_f_mean_mm", mean(torso)},
          {"torso_f_p95_mm", quantile(torso, 0.95)},
          {"core_f_mean_mm", mean(core)},
          {"core_f_p95_mm", quantile(core, 0.95)}};
}

std::vector<Ball> balls_at(const Bake& bake, bool detect) {
  std::vector<Ball> balls;
  for (const baker::BoundSphere& s : bake.binding.spheres) {
    balls.push_back({s.rest.center, detect ? s.detect_radius : s.rest.radius});
  }
  return balls;
}

Columns cover(const Study& study, const baker::SampledBody& samples, const Bake& bake) {
  Columns out;
  for (const bool detect : {false, true}) {
    const std::vector<Ball> balls = balls_at(bake, detect);
    const std::string suffix = detect ? "_detect" : "_fit";
    out.push_back({"uncovered_body" + suffix, samples.measure(balls, [](Index) { return true; }).uncovered});
    out.push_back(
        {"uncovered_core" + suffix, samples.measure(balls, [&](Index t) { return study.core()[t]; }).uncovered});
  }
  return out;
}

Columns refit_error(const Study& study, const Bake& bake) {
  const std::vector<baker::SkinFollower> followers = skin_followers(bake);
  const baker::OpenAsset asset({reinterpret_cast<const char*>(bake.asset.data()), bake.asset.size()}, "a bake");
  std::vector<double> center, radius, sphere;
  for (const Animation& animation : study.animations()) {
    for (const std::vector<Vec3>& frame : animation.frames) {
      const std::vector<Sphere> spheres = refit_spheres(asset, baker::pack(frame), SC_RADIUS_FIT);
      for (std::size_t s = 0; s < spheres.size(); ++s) {
        const Ball best = followers[s].at(frame);
        const Sphere& got = spheres[s];
        const double moved = study.mm() * (Vec3(got.x, got.y, got.z) - best.center).norm();
        const double grown = study.mm() * std::abs(static_cast<double>(got.radius) - best.radius);
        center.push_back(moved);
        radius.push_back(grown / (study.mm() * best.radius));
        sphere.push_back(moved + grown);  // the Hausdorff distance of the two
      }
    }
  }
  return {{"refit_center_mean_mm", mean(center)}, {"refit_center_p95_mm", quantile(center, 0.95)},
          {"refit_radius_mean", mean(radius)},    {"refit_radius_p95", quantile(radius, 0.95)},
          {"refit_sphere_mean_mm", mean(sphere)}, {"refit_sphere_p95_mm", quantile(sphere, 0.95)}};
}

Columns running_costs(const Study& study, const std::vector<FrameCost>& frames) {
  Columns out{{"tests_m1", frames[0].methods[kM1].tests}, {"tests_m2", frames[0].methods[kM2].tests}};
  for (std::size_t m = 0; m < kMethods.size(); ++m) {
    std::string method = kMethods[m];
    std::transform(method.begin(), method.end(), method.begin(),
                   [](char c) { return c == ' ' ? '_' : static_cast<char>(std::tolower(c)); });
    std::vector<double> overlaps, us;
    std::vector<std::vector<double>> us_of(study.animations().size());
    for (const FrameCost& frame : frames) {
      overlaps.push_back(static_cast<double>(frame.methods[m].overlaps));
      us.push_back(frame.methods[m].us);
      us_of[frame.animation].push_back(frame.methods[m].us);
    }
    if (m != kRefit) out.push_back({"overlaps_" + method, mean(overlaps)});
    out.push_back({"us_" + method, median(us)});
    for (std::size_t a = 0; a < us_of.size(); ++a) {
      out.push_back({"us_" + method + "_" + study.animations()[a].name, median(us_of[a])});
    }
  }
  return out;
}

struct Measured {
  Columns columns;
  Table accuracy;
  std::vector<std::uint8_t> asset;
};

Measured measure(const Study& study, const baker::SampledBody& samples, const Setting& setting, bool with_accuracy) {
  const Bake bake = study.bake(setting.profile, setting.json);
  Measured out;
  out.columns = {{"series", setting.series},
                 {"value", setting.value},
                 {"profile", setting.profile},
                 {"settings", setting.json},
                 {"penetration_depth", bake.settings.fit.penetration_depth}};
  for (const Columns& part :
       {count(bake), fit_error(study, bake), cover(study, samples, bake), refit_error(study, bake)}) {
    out.columns.insert(out.columns.end(), part.begin(), part.end());
  }
  if (with_accuracy) out.accuracy = measure_accuracy(study, bake).spheres;
  out.asset = bake.asset;
  return out;
}

}  // namespace

SweepTables measure_sweep(const Study& study, const baker::SampledBody& samples, const std::vector<Setting>& settings,
                          const std::string& accuracy_series, int repetitions,
                          const std::function<void(const std::string&)>& progress) {
  std::vector<Measured> measured(settings.size());
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    for (std::size_t i = next++; i < settings.size(); i = next++) {
      try {
        {
          const std::lock_guard lock(mutex);
          progress(fmt::format("{} {:g} ({} of {})", settings[i].series, settings[i].value, i + 1, settings.size()));
        }
        measured[i] = measure(study, samples, settings[i], settings[i].series == accuracy_series);
      } catch (...) {
        const std::lock_guard lock(mutex);
        failure = std::current_exception();
        next = settings.size();
      }
    }
  };
  {
    std::vector<std::jthread> threads;
    for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) threads.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);

  progress("timing every setting");
  std::vector<std::vector<std::uint8_t>> assets;
  for (const Measured& one : measured) assets.push_back(one.asset);
  const std::vector<std::vector<FrameCost>> costs = run_frames(assets, study.animations(), repetitions);
  SweepTables out{{"sweep", {}, {}}, {"figure13_series", {}, {}}};
  for (std::size_t i = 0; i < settings.size(); ++i) {
    Columns& columns = measured[i].columns;
    for (Column& column : running_costs(study, costs[i])) columns.push_back(std::move(column));
    out.sweep.columns.clear();
    std::vector<Cell> row;
    for (const Column& column : columns) {
      out.sweep.columns.push_back(column.name);
      row.push_back(column.value);
    }
    out.sweep.add(std::move(row));

    const Table& accuracy = measured[i].accuracy;
    if (accuracy.empty()) continue;
    out.accuracy.columns = accuracy.columns;
    out.accuracy.columns.insert(out.accuracy.columns.begin(), accuracy_series);
    for (std::vector<Cell> sphere : accuracy.rows) {
      sphere.insert(sphere.begin(), settings[i].value);
      out.accuracy.add(std::move(sphere));
    }
  }
  return out;
}

Table measure_quality(const Study& study, const baker::SampledBody& samples, const std::vector<NamedBake>& bakes) {
  Table out{"quality",
            {"set", "radius", "part", "spheres", "coverage", "outside_volume", "volume_ratio", "protrusion_p95_mm",
             "gap_mean_mm", "gap_p95_mm", "uncovered_surface"},
            {}};
  const baker::Regions& regions = study.paper().regions;
  const std::vector<std::pair<std::string, baker::SampledBody::Part>> parts{
      {"body", [](Index) { return true; }},
      {"core", [&](Index t) { return study.core()[t]; }},
      {"torso", [&](Index t) { return study.core()[t] && regions.of_triangle[t] == baker::kTorso; }}};
  const auto add = [&](const std::string& set, const std::string& radius, const std::vector<Ball>& balls) {
    for (const auto& [part, inside] : parts) {
      const baker::SphereQuality q = samples.measure(balls, inside);
      out.add({set, radius, part, balls.size(), q.coverage, q.outside, q.volume_ratio, study.mm() * q.protrusion_p95,
               study.mm() * q.gap_mean, study.mm() * q.gap_p95, q.uncovered});
    }
  };
  for (const auto& [name, bake] : bakes) {
    std::vector<Ball> fitted;
    for (const baker::FittedSphere& s : bake.spheres.spheres) fitted.push_back(s.ball);
    const auto torso_as = [&](Ball baker::TorsoFit::*ball) {
      std::vector<Ball> balls = fitted;
      for (std::size_t s = 0; s < bake.spheres.torso.size(); ++s) balls[s] = bake.spheres.torso[s].*ball;
      return balls;
    };
    if (name == "paper") {
      add("paper, torso phi1", "fit", torso_as(&baker::TorsoFit::phi1));
      add("paper, torso phi1'", "fit", fitted);
      add("paper, torso phi2", "fit", torso_as(&baker::TorsoFit::phi2));
      add("paper, after its refit at rest", "fit", balls_at(bake, false));
    } else {
      add(name, "fit", fitted);
      add(name, "detect", balls_at(bake, true));
    }
  }
  return out;
}

}  // namespace spherechain::paper
