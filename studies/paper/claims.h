// SPDX-License-Identifier: GPL-3.0-or-later
// The claims of the paper, evaluated on the tables of the run and nothing else.
#pragma once

#include <string>
#include <vector>

#include "experiments.h"
#include "gpu_time.h"

namespace spherechain::paper {

struct Results {
  AccuracyTables accuracy;
  Table running_time;
  SweepTables sweep;
  Table quality;
  Table trees;
  GpuTime gpu;          // empty where no GPU was at hand
  std::string machine;  // one line: processor, cores, compiler
};

// The sweep's series. PD runs without head, hands and feet (profile paper) and with them (balanced).
inline constexpr const char *kDepthPaper = "penetration_depth", *kDepthExtremities = "penetration_depth_extremities",
                            *kPerLevel = "spheres_per_level", *kDelta = "delta", *kPivotsPaper = "pivots_paper",
                            *kPivotsMoments = "pivots_moments";

// The numbers of the paper that disagree (docs/paper.md): six chains of 23 are 138 entries.
inline constexpr double kStatedSpheres = 80, kSummedSpheres = 46, kStatedChain = 23, kChainCount = 6,
                        kStatedDepth = 0.3;

inline constexpr const char *kHolds = "holds", *kInPart = "holds in part", *kFails = "does not hold",
                            *kNotRun = "not run";

struct Verdict {
  std::string verdict, finding;
};
inline const char* graded(bool all, bool some) { return all ? kHolds : some ? kInPart : kFails; }

// claims.csv: id, where, the paper says, rule, verdict, finding.
Table evaluate_claims(const Results& results);
// readings.csv: the paper's two sphere counts and our bakes nearest to them.
Table compare_readings(const Results& results);
// defaults.csv: setting, current, follows, rule, finding.
Table derive_defaults(const Results& results);

// Which of several settings follows. bend() takes the point where a curve of falling error over rising cost bends most:
// farthest from the line between its ends, both axes scaled to 1. cheapest_within_tenth() takes the cheapest whose
// error is within a tenth of the least.
std::size_t bend(const std::vector<double>& cost, const std::vector<double>& error);
std::size_t cheapest_within_tenth(const std::vector<double>& cost, const std::vector<double>& error);

// The row of a series whose mesh has nearest to `spheres`.
std::size_t nearest_count(const Table& series, double spheres);

}  // namespace spherechain::paper
