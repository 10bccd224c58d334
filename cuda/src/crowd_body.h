// SPDX-License-Identifier: MIT
// The crowd's kernel, thread by thread, in steps with a barrier between them. It is compiled for the device, and by any
// C++ compiler for the tests, which run a block's threads one after the other, step by step, or all at once. The
// arithmetic is that of refit_bones.h and detect.h: multiply-adds where fused() is written, and nowhere else.
#pragma once

#include "crowd_cover.h"
#include "crowd_instance.h"
#include "crowd_moments.h"
#include "crowd_outputs.h"
#include "crowd_pairs.h"
#include "crowd_refit.h"

namespace spherechain::cuda {

// Where a group's spheres come from.
enum class Way { kSpheres, kBones, kMorphs, kMoments, kCovers };

SPHERECHAIN_HD Way way_of(const GroupView& v) {
  return v.cover_entries != nullptr   ? Way::kCovers
         : v.matrices == nullptr      ? Way::kSpheres
         : v.runs != nullptr          ? Way::kMoments
         : v.morph_weights == nullptr ? Way::kBones
                                      : Way::kMorphs;
}

// Something that a warp does for an instance, if it is wanted.
template <typename Step>
struct OwnStep {
  bool is_wanted;
  Step run;
};

template <typename Step>
SPHERECHAIN_HD OwnStep<Step> own_step(bool is_wanted, const Step& run) {
  return {is_wanted, run};
}

// Where they come as spheres. `run` takes a warp through the steps for each of its instances, and waits for the warp
// after each.
template <typename Run>
SPHERECHAIN_HD void run_sphere_block(const GroupView& v, const Shared& shared, const Run& run) {
  run.for_instances(v, shared,  //
                    own_step(true, [&](const Own& own) { load_spheres(v, own); }),
                    own_step(v.has_padding, [&](const Own& own) { pad_spheres(v, own); }),
                    own_step(v.bounds != nullptr, [&](const Own& own) { box_spheres(v, own); }),
                    own_step(v.bounds != nullptr, [&](const Own& own) { join_boxes(own); }),
                    own_step(true, [&](const Own& own) { see_spheres(v, own); }),
                    own_step(true, [&](const Own& own) { find_pairs(v, own); }),
                    own_step(true, [&](const Own& own) { decide_pairs(v, own); }),
                    own_step(v.bounds != nullptr, [&](const Own& own) { reach_spheres(v, own); }),
                    own_step(true, [&](const Own& own) { write_instance(v, own); }),
                    own_step(v.pairs != nullptr, [&](const Own& own) { write_pairs(v, own); }));
}

// Where they come from bones. `run` runs a step for the block's threads and waits for all of them.
template <Way kWay, typename Run>
SPHERECHAIN_HD void run_bone_block(const GroupView& v, const Shared& shared, const Run& run) {
  constexpr bool kCovers = kWay == Way::kCovers;
  run([&](const Place& at) {
    start_dealing(shared, at);
    load_matrices(v, shared, at);
  });
  if (kCovers) {
    run([&](const Place& at) { size_bones(v, shared, at); });
    run([&](const Place& at) { cover_spheres(v, shared, at); });
  } else if (kWay == Way::kMoments) {
    run([&](const Place& at) { find_reference(v, shared, at); });
    run([&](const Place& at) { center_matrices(v, shared, at); });
    run([&](const Place& at) { refit_runs(v, shared, at); });
  } else {
    run([&](const Place& at) { refit_spheres<kWay == Way::kMorphs>(v, shared, at); });
  }
  if (v.refitted != nullptr) {
    run([&](const Place& at) { kCovers ? write_covers(v, shared, at) : write_spheres(v, shared, at); });
  }
  run([&](const Place& at) { prepare_pairs<kCovers>(v, shared, at); });
  run([&](const Place& at) { test_pairs<kCovers>(v, shared, at); });
  if (has_queue(v.sphere_count, kCovers)) {
    run([&](const Place& at) { decide_queued(v, shared, at); });
  }
  run([&](const Place& at) { write_instances(v, shared, at); });
  if (v.pairs != nullptr) {
    run([&](const Place& at) { write_pairs(v, shared, at); });
  }
}

template <Way kWay, typename Run>
SPHERECHAIN_HD void run_block(const GroupView& v, const Shared& shared, const Run& run) {
  if constexpr (kWay == Way::kSpheres) {
    run_sphere_block(v, shared, run);
  } else {
    run_bone_block<kWay>(v, shared, run);
  }
}

template <typename Run>
SPHERECHAIN_HD void run_any_block(const GroupView& v, const Shared& shared, const Run& run) {
  switch (way_of(v)) {
    case Way::kSpheres:
      return run_block<Way::kSpheres>(v, shared, run);
    case Way::kBones:
      return run_block<Way::kBones>(v, shared, run);
    case Way::kMorphs:
      return run_block<Way::kMorphs>(v, shared, run);
    case Way::kMoments:
      return run_block<Way::kMoments>(v, shared, run);
    case Way::kCovers:
      return run_block<Way::kCovers>(v, shared, run);
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
    asm volatile(
        ""
        : "+r"(here.thread));  // or what follows from it would be kept in registers, or spilled, from the start
    const std::uint32_t count = instances_in(v, here);
    for (std::uint32_t place = here.warp(); place < count; place += here.warps()) {
      const Own own(v, shared, here, place);
      (run_own(steps, own), ...);
    }
  }

 private:
  template <typename Step>
  SPHERECHAIN_HD void run_own(const Step& step, const Own& own) const {
    if (step.is_wanted) {
      step.run(own);
      barriers.warp();
    }
  }
};

// What a block of its launch does where the memory is in scratch. `run` is made for a block of the group.
template <typename MakeRun>
SPHERECHAIN_HD void run_blocks_in_scratch(const GroupView& v, std::uint32_t first, const MakeRun& make_run) {
  const Shared memory(v.scratch + first * v.layout.size, v.layout);
  for (std::uint32_t block = first; block < blocks_of(v); block += v.scratch_blocks) {
    run_any_block(v, memory, make_run(block));
  }
}

}  // namespace spherechain::cuda
