// SPDX-License-Identifier: MIT
// Crowds, against a job of its own for each instance.
#include <algorithm>
#include <thread>

#include "fuzz_case.h"
#include "spherechain/crowd.h"
#include "spherechain/detect.h"

namespace spherechain::test {
namespace {

using Task = void (*)(void* data, std::size_t i);

void in_reverse(void*, std::size_t count, Task task, void* data) {
  for (std::size_t i = count; i > 0; --i) task(data, i - 1);
}

void on_threads(void*, std::size_t count, Task task, void* data) {
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < count; ++i) threads.emplace_back(task, data, i);
  for (std::thread& thread : threads) thread.join();
}

// Breaks the promise in ways that must not matter.
void past_the_end(void*, std::size_t count, Task task, void* data) {
  for (std::size_t i = 0; i < count; ++i) task(data, i), task(data, i);
  task(data, count);
  task(data, ~std::size_t{0});
}

// Breaks the promise in a way that leaves nothing to expect of the figures.
void never(void*, std::size_t, Task, void*) {}

struct CrowdCall {
  CrowdJob job;
  CrowdContext context;
  Filter filter;
  sc_filter c_filter{};
  sc_crowd_job c_job = SC_CROWD_JOB_INIT;
};

struct Expected {
  std::vector<std::uint32_t> counts;
  std::vector<std::uint64_t> bits;
  std::vector<CrowdPair> pairs;
};

Expected expected_of(Case& c, const CrowdJob& job) {
  Expected expected;
  const std::size_t words = DetectJob::bit_words(c.asset), stride = job.stride == 0 ? c.n : job.stride;
  expected.bits.resize(job.instance_count * words);
  std::vector<Sphere> spheres(c.n);
  std::vector<Pair> pairs(c.n * c.n);
  for (std::size_t i = 0; i < job.instance_count; ++i) {
    if (job.bones.data != nullptr) {
      RefitBonesJob refit;
      refit.asset = &c.asset;
      refit.bones = job.bones;
      refit.bones.data = job.bones.data + i * (job.instance_stride / sizeof(float));
      if (job.morph_weights.size > 0) {
        refit.morph_weights = {job.morph_weights.data + i * c.asset.morph_count(), c.asset.morph_count()};
      }
      refit.radius = job.radius;
      refit.target = Target::kScalar;
      refit.spheres = {spheres.data(), c.n};
      c.expect(refit.run() == Status::kOk, "an instance's refit");
    } else {
      std::copy(job.spheres + i * stride, job.spheres + i * stride + c.n, spheres.begin());
    }
    DetectJob detect;
    detect.asset = &c.asset;
    detect.spheres = {spheres.data(), c.n};
    detect.radius = job.radius;
    detect.target = Target::kScalar;
    detect.filter = job.filter;
    detect.pairs = {pairs.data(), pairs.size()};
    detect.bits = {expected.bits.data() + i * words, words};
    c.expect(detect.run() == Status::kOk, "an instance's detection");
    expected.counts.push_back(static_cast<std::uint32_t>(detect.pair_count));
    for (std::size_t k = 0; k < detect.pair_count; ++k) {
      expected.pairs.push_back({static_cast<std::uint32_t>(i), pairs[k]});
    }
  }
  return expected;
}

void draw_spheres(Case& c, CrowdJob& job) {
  const std::size_t strides[] = {0, c.n, c.n + 1, c.n + 3};
  job.stride = c.random.pick(strides);
  const std::size_t stride = job.stride == 0 ? c.n : job.stride;
  const std::size_t count = job.instance_count == 0 ? 0 : (job.instance_count - 1) * stride + c.n;
  Sphere* spheres = c.arena.add<Sphere>(count);
  fill_figures(c, &spheres->x, 4 * count);
  job.spheres = spheres;
}

void draw_bones(Case& c, CrowdJob& job) {
  job.stride = c.random.below(3);  // of spheres: of no consequence
  job.bones.layout = static_cast<MatrixLayout>(c.random.below(4));
  job.bones.stride = size_of(job.bones.layout) + 4 * c.random.below(3);
  job.bones.count = c.asset.bone_count();
  const std::size_t own = (job.bones.count - 1) * job.bones.stride + size_of(job.bones.layout);
  job.instance_stride = own + 4 * c.random.below(5);
  const std::size_t floats =
      job.instance_count == 0 ? 0 : ((job.instance_count - 1) * job.instance_stride + own) / sizeof(float);
  float* matrices = c.arena.add<float>(floats);
  fill_figures(c, matrices, floats);
  job.bones.data = matrices;
  if (c.random.one_in(2)) {
    job.morph_weights.size = job.instance_count * c.asset.morph_count() + c.random.below(2);
    float* weights = c.arena.add<float>(job.morph_weights.size);
    fill_figures(c, weights, job.morph_weights.size);
    job.morph_weights.data = weights;
    // Past a whole number an instance the job would take one weight for all; it is as many as are there that count.
    job.morph_weights.size = job.instance_count * c.asset.morph_count();
  }
}

void spoil_crowd(Case& c, CrowdCall& call, std::uint32_t way, Spoiled& spoiled) {
  CrowdJob& job = call.job;
  const bool has_bones = job.bones.data != nullptr;
  switch (way) {
    case 0:
    case 1:
      return spoil_asset(c, job, call.c_job, way, spoiled);
    case 2:
      job.spheres = nullptr;
      job.bones.data = nullptr;
      return spoiled.with(Status::kNullArgument);
    case 3: {
      const std::size_t counts[] = {std::size_t{1} << 32, 0xFFFFFFFFU, ~std::size_t{0}, std::size_t{1} << 58};
      job.instance_count = c.random.pick(counts);
      return spoiled.with(Status::kBadArgument);
    }
    case 4: {
      const std::size_t counts[] = {0, 0xFFFFFFFFU, ~std::size_t{0}};
      job.task_count = c.random.pick(counts);
      return spoiled.with(Status::kBadArgument);
    }
    case 5:
      job.context = nullptr;
      return spoiled.with(Status::kNullArgument);
    case 6:
      call.context.words.size = c.random.up_to(CrowdContext::words_needed(c.asset, job.task_count) - 1);
      return spoiled.with(Status::kContextTooSmall);
    case 7:
      job.counts = {nullptr, job.instance_count};
      return spoiled.with(Status::kNullArgument);
    case 8:
      if (job.instance_count > 1 && job.instance_count < 1000) {  // not spoiled above
        job.counts = {c.arena.add<std::uint32_t>(job.instance_count), c.random.up_to(job.instance_count - 2) + 1};
        spoiled.with(Status::kBadArgument);
      }
      return;
    case 9:
      job.counts = {};
      job.pairs = {c.arena.add<CrowdPair>(1), 1};
      return spoiled.with(Status::kBadArgument);
    case 10:
      job.bits = {c.arena.add<std::uint64_t>(1), job.instance_count * DetectJob::bit_words(c.asset) + 1};
      return spoiled.with(Status::kBadArgument);
    case 11:
      job.bits = {nullptr, 1};
      return spoiled.with(Status::kNullArgument);
    case 12:
      job.radius = draw_none<RadiusKind>(c, 2);
      call.c_job.radius = draw_c_none(c, 2);
      return spoiled.with(Status::kBadArgument);
    case 13:
      job.target = draw_none<Target>(c, 7);
      call.c_job.target = draw_c_none(c, 7);
      return spoiled.with(Status::kUnsupportedTarget);
    case 14:
      job.filter = &call.filter;
      if (call.filter.ignored.data == nullptr) call.filter = draw_filter(c);
      return spoil_filter(c, call.filter, spoiled);
    case 15:
      if (!has_bones && c.n > 1) {
        job.stride = 1 + c.random.up_to(c.n - 2);
        spoiled.with(Status::kTooFewSpheres);
      } else if (has_bones) {
        job.spheres = c.arena.add<Sphere>(1);
        spoiled.with(Status::kBadArgument);
      }
      return;
    case 16:
      if (has_bones) {
        job.bones.count = c.random.up_to(job.bones.count - 1);
        spoiled.with(Status::kTooFewBones);
      }
      return;
    case 17:
      if (has_bones) {
        const std::size_t strides[] = {0, 44, job.bones.stride + 1, ~std::size_t{0}, std::size_t{1} << 62};
        (c.random.one_in(2) ? job.bones.stride : job.instance_stride) = c.random.pick(strides);
        spoiled.with(Status::kBadStride);
      }
      return;
    case 18:
      if (has_bones && c.asset.morph_count() > 1) {
        job.morph_weights = {c.arena.add<float>(1), job.instance_count * c.asset.morph_count() - 1};
        spoiled.with(Status::kTooFewMorphs);
      }
      return;
    case 19:
      put_askew(c, call.context.words.data);
      return spoiled.with(Status::kMisaligned);
    case 20:
      put_over(c, call.context.words.data,
               has_bones ? bytes_of(job.bones.data, 12) : bytes_of(job.spheres, job.spheres == nullptr ? 0 : c.n));
      return spoiled.with(Status::kSharedMemory);
    default:
      if (job.bits.size > 0) {
        put_over(c, job.bits.data, bytes_of(call.context.words.data, call.context.words.size));
        spoiled.with(Status::kSharedMemory);
      }
  }
}

void fill_in_c(CrowdCall& call) {
  const CrowdJob& job = call.job;
  sc_crowd_job& out = call.c_job;
  out.spheres = reinterpret_cast<const sc_sphere*>(job.spheres);
  out.instance_count = job.instance_count;
  out.stride = job.stride;
  out.bones = {job.bones.data, job.bones.count, job.bones.stride, static_cast<sc_matrix_layout>(job.bones.layout), 0};
  out.instance_stride = job.instance_stride;
  out.morph_weights = job.morph_weights.data;
  out.morph_weight_count = job.morph_weights.size;
  out.filter = job.filter == nullptr ? nullptr : &call.c_filter;
  out.scratch = job.context == nullptr ? nullptr : call.context.words.data;
  out.scratch_words = call.context.words.size;
  out.parallel_for = job.hook.parallel_for;
  out.task_count = job.task_count;
  out.counts = job.counts.data;
  out.counts_capacity = job.counts.size;
  out.bits = job.bits.data;
  out.bit_words = job.bits.size;
  out.pairs = reinterpret_cast<sc_crowd_pair*>(job.pairs.data);
  out.pair_capacity = job.pairs.size;
}

void draw_outputs(Case& c, CrowdCall& call, std::size_t there_are) {
  CrowdJob& job = call.job;
  job.task_count = 1 + c.random.below(c.random.one_in(2) ? 1 : 7);
  call.context.words.size = CrowdContext::words_needed(c.asset, job.task_count) + c.random.below(3);
  call.context.words.data = c.arena.add<std::uint64_t>(call.context.words.size);
  job.context = &call.context;
  job.bits.size = c.random.one_in(2) ? job.instance_count * DetectJob::bit_words(c.asset) : 0;
  job.bits.data = c.arena.add<std::uint64_t>(job.bits.size);
  if (!c.random.one_in(3)) {
    job.counts.size = job.instance_count + c.random.below(2);
    job.counts.data = c.arena.add<std::uint32_t>(job.counts.size);
    job.pairs.size = job.counts.size > 0 ? draw_capacity(c, there_are) : 0;
    job.pairs.data = c.arena.add<CrowdPair>(job.pairs.size);
  }
  using Hook = decltype(job.hook.parallel_for);
  const Hook hooks[] = {nullptr,
                        nullptr,
                        in_reverse,
                        past_the_end,
                        c.random.one_in(50) ? on_threads : in_reverse,
                        c.random.one_in(4) ? never : in_reverse};
  job.hook.parallel_for = c.random.pick(hooks);
}

void check_expected(Case& c, const CrowdJob& job, const Expected& expected, Status status) {
  const std::size_t there_are = expected.pairs.size();
  c.expect(job.pair_count == there_are, "the count of pairs");
  c.expect((status == Status::kOverflow) == (job.pairs.size > 0 && job.pairs.size < there_are), "overflow");
  c.expect(job.counts.size == 0 || std::equal(expected.counts.begin(), expected.counts.end(), job.counts.begin()),
           "the counts");
  c.expect(job.bits.size == 0 || std::equal(expected.bits.begin(), expected.bits.end(), job.bits.begin()), "the bits");
  c.expect(
      std::equal(job.pairs.begin(), job.pairs.begin() + std::min(job.pairs.size, there_are), expected.pairs.begin()),
      "the pairs");
}

}  // namespace

void fuzz_crowd(Case& c) {
  if (!draw_asset(c)) {
    return;
  }
  CrowdCall call;
  CrowdJob& job = call.job;
  job.asset = &c.asset;
  const std::size_t counts[] = {0, 1, 2, 5, 16, 17, 33};
  job.instance_count = c.n > 80 ? c.random.below(4) : c.random.pick(counts);
  job.radius = static_cast<RadiusKind>(c.random.below(2));
  job.target = draw_target(c);
  const bool has_bones = c.asset.bone_count() > 0 && c.random.one_in(2);
  has_bones ? draw_bones(c, job) : draw_spheres(c, job);
  if (c.random.one_in(2)) {
    call.filter = draw_filter(c);
    job.filter = &call.filter;
  }
  const Expected expected = expected_of(c, job);
  draw_outputs(c, call, expected.pairs.size());
  const CrowdJob sound = job;
  const bool is_dealt = job.hook.parallel_for != never;

  call.c_job.asset = c.c_asset;
  call.c_job.radius = static_cast<sc_radius>(job.radius);
  call.c_job.target = static_cast<sc_target>(draw_target(c));
  Spoiled spoiled;
  if (job.instance_count > 0) {
    spoil_some(c, 22, [&](std::uint32_t way) { spoil_crowd(c, call, way, spoiled); });
  }
  call.c_filter = to_c(call.filter);
  fill_in_c(call);
  job.pair_count = call.c_job.pair_count = 77;
  run_both(
      c, spoiled,
      [&] {
        const Status status = job.run();
        if (status != Status::kOk && status != Status::kOverflow) {
          c.expect(job.pair_count == 77, "a count of nothing");
        } else if (is_dealt) {
          check_expected(c, job, expected, status);
        }
        return status;
      },
      [&] { return sc_crowd(&call.c_job); },
      [&](Status) {
        return std::vector<Bytes>{bytes_of(job.counts.data, std::min(job.counts.size, sound.instance_count)),
                                  bytes_of(job.bits.data, job.bits.size), bytes_of(job.pairs.data, job.pairs.size),
                                  bytes_of(call.context.words.data, call.context.words.size)};
      },
      // What scratch memory and pairs past their number hold is of no consequence, and figures that no task worked out
      // are none.
      [&](bool ran) {
        if (ran) std::fill(call.context.words.begin(), call.context.words.end(), std::uint64_t{0});
        if (ran && !is_dealt) std::fill(job.counts.begin(), job.counts.end(), 0U);
        for (std::size_t i = job.pair_count; ran && is_dealt && i < job.pairs.size; ++i) job.pairs[i] = {};
      },
      is_dealt);
  c.expect(call.c_job.pair_count == job.pair_count, "the C API counts something else");
}

}  // namespace spherechain::test
