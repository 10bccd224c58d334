// SPDX-License-Identifier: MIT
// The crowd's kernel, thread by thread, in steps with a barrier between them. It is compiled for the device, and by any
// C++ compiler for the tests, which run a block's threads one after the other, step by step. The arithmetic is that of
// refit_bones.h and detect.h: multiply-adds where fused() is written, and nowhere else.
#pragma once

#include "crowd_outputs.h"
#include "crowd_pairs.h"
#include "crowd_refit.h"

namespace spherechain::cuda {

// A block. `run` runs a step for its threads and waits for all of them.
template <bool kFromBones, bool kMorphs, typename Run>
SPHERECHAIN_HD void run_block(const GroupView& v, const Shared& shared, const Run& run) {
  if (kFromBones) {
    run([&](const Place& at) {
      start_dealing(shared, at);
      load_matrices(v, shared, at);
    });
    run([&](const Place& at) { refit_spheres<kMorphs>(v, shared, at); });
  } else {
    run([&](const Place& at) {
      start_dealing(shared, at);
      load_spheres(v, shared, at);
    });
  }
  if (kFromBones && v.refitted != nullptr) {
    run([&](const Place& at) { write_spheres(v, shared, at); });
  }
  run([&](const Place& at) { prepare_pairs(v, shared, at); });
  run([&](const Place& at) { test_pairs(v, shared, at); });
  run([&](const Place& at) { write_instances(v, shared, at); });
  if (v.pairs != nullptr) {
    run([&](const Place& at) { write_pairs(v, shared, at); });
  }
}

}  // namespace spherechain::cuda
