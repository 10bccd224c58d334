// SPDX-License-Identifier: GPL-3.0-or-later
// The experiments: each turns bakes and runs into tables.
#pragma once

#include <functional>

#include "sphere_quality.h"
#include "study.h"
#include "table.h"

namespace spherechain::paper {

// The paper's parameters are delta = 0.25 (0.015 of the height), PD = 30 %, N_s = 2, N_r = 80: profile `paper`.

// Figure 13. `rays`: |F| of every torso sphere at the points its level's disk hits; ray r0 points forward, r20 to the
// left, r40 back. A sphere's own half of the disk is r0 to r40 on the left, r40 to r79 and r0 on the right. `phi2 rays`
// is the minimum enclosing ball of those hits instead of the band's vertices. `spheres`: a row a sphere.
struct AccuracyTables {
  Table rays, spheres;
};
AccuracyTables measure_accuracy(const Study& study, const Bake& bake);

// Figure 15: a row a frame and method.
Table measure_running_time(const Study& study, const Bake& bake, int repetitions);

// A bake to measure: one point of a series.
struct Setting {
  std::string series;
  double value;
  std::string profile, json;  // as the command line's --profile and --config
};

// Counts, time, fit, cover and refit error of each setting, a row each, and Figure 13's rows of the series
// `accuracy_series` with the series' value in front. Bakes run on all cores, the timing after them on one.
struct SweepTables {
  Table sweep, accuracy;
};
SweepTables measure_sweep(const Study& study, const baker::SampledBody& samples, const std::vector<Setting>& settings,
                          const std::string& accuracy_series, int repetitions,
                          const std::function<void(const std::string&)>& progress);

// The field's measures of sphere sets: a row for each set, radius and part of the body (all of it; what the paper
// covers; the torso of that).
struct NamedBake {
  std::string name;
  const Bake& bake;
};
Table measure_quality(const Study& study, const baker::SampledBody& samples, const std::vector<NamedBake>& bakes);

}  // namespace spherechain::paper
