// SPDX-License-Identifier: MIT
// The work of a thread of the crowd's kernels, in steps with a barrier after each. It compiles for the device and, for
// the tests, for any CPU, where a block's threads run one after another, step by step, or all at once. Multiply-adds
// are used where fused() is written and nowhere else: see docs/arithmetic.md.
#pragma once

#include "crowd_instance.h"
#include "crowd_moments.h"
#include "crowd_pairs.h"

namespace spherechain::cuda {

// `run` takes a warp through the steps for each of its instances, and waits for the warp after each step.
template <typename Run>
SPHERECHAIN_HD void run_sphere_block(const GroupView& v, const Shared& shared, const Run& run) {
  run.for_instances(
      v, shared,  //
      [&](const WarpInstance& w) { load_spheres(v, w); }, [&](const WarpInstance& w) { see_spheres(v, w); },
      [&](const WarpInstance& w) { find_pairs(v, w); }, [&](const WarpInstance& w) { decide_pairs(v, w); },
      [&](const WarpInstance& w) { write_instance(v, w); }, [&](const WarpInstance& w) { write_pairs(v, w); });
}

// `run` runs a step for the block's threads and waits for all of them.
template <typename Run>
SPHERECHAIN_HD void run_bone_block(const GroupView& v, const Shared& shared, const Run& run) {
  run([&](const Place& at) { load_matrices(v, shared, at); });
  run([&](const Place& at) { find_reference(v, shared, at); });
  run([&](const Place& at) { center_matrices(v, shared, at); });
  run([&](const Place& at) { refit_runs(v, shared, at); });
  if (v.refitted != nullptr) {
    run([&](const Place& at) { write_spheres(v, shared, at); });
  }
  run([&](const Place& at) { prepare_pairs(v, shared, at); });
  run([&](const Place& at) { test_pairs(v, shared, at); });
  if (has_queue(v.sphere_count)) {
    run([&](const Place& at) { decide_queued(v, shared, at); });
  }
  run([&](const Place& at) { write_instances(v, shared, at); });
  if (v.pairs != nullptr) {
    run([&](const Place& at) { write_pairs(v, shared, at); });
  }
}

template <typename Run>
SPHERECHAIN_HD void run_block(const GroupView& v, const Shared& shared, const Run& run) {
  if (v.pose.bones == nullptr) {
    run_sphere_block(v, shared, run);
  } else {
    run_bone_block(v, shared, run);
  }
}

// Takes one thread through the steps. `Barriers`: block() and warp() wait for the threads of the block and of the warp.
template <typename Barriers>
struct RunThread {
  Place at;
  Barriers barriers;

  template <typename Step>
  SPHERECHAIN_HD void operator()(const Step& step) const {
    step(at);
    barriers.block();
  }
  template <typename... Steps>
  SPHERECHAIN_HD void for_instances(const GroupView& v, const Shared& shared, const Steps&... steps) const {
    Place here = at;
    asm volatile("" : "+r"(here.thread));  // else all that follows from it is kept in registers from the start
    const std::uint32_t count = instances_in(v, here);
    for (std::uint32_t place = here.warp(); place < count; place += here.warps()) {
      const WarpInstance w(shared, here, place);
      ((steps(w), barriers.warp()), ...);
    }
  }
};

// Runs block `first` of a launch whose blocks work in scratch memory: it takes every scratch_blocks-th block of the
// group. make_run(b) makes the `run` of block b.
template <typename MakeRun>
SPHERECHAIN_HD void run_blocks_in_scratch(const GroupView& v, std::uint32_t first, const MakeRun& make_run) {
  const Shared memory(static_cast<unsigned char*>(v.scratch) + first * v.layout.size, v.layout);
  for (std::uint32_t block = first; block < blocks_of(v); block += v.scratch_blocks) {
    run_block(v, memory, make_run(block));
  }
}

}  // namespace spherechain::cuda
