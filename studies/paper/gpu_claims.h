// SPDX-License-Identifier: GPL-3.0-or-later
// The claims of the paper about the GPU, evaluated on figure16_medians.csv.
#pragma once

#include "claims.h"

namespace spherechain::paper {

// "On the GPU M1 takes less time than M2", at the two sphere counts nearest to the paper's. A lead is a twentieth.
Verdict evaluate_gpu_m1_faster(const Table& medians);

// "Parallelism takes about 10,000 spheres or more": the GPU, launch and copies included, against one core of a CPU.
Verdict evaluate_gpu_needs_many(const Table& medians);

}  // namespace spherechain::paper
