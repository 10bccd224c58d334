// SPDX-License-Identifier: MIT
// Crowds, against a job of its own for each instance.
#include <algorithm>
#include <thread>

#include "fuzz_case.h"
#include "runtime/src/pose/pose.h"

namespace spherechain::test {
namespace {

using Task = void (*)(void* data, std::size_t i);

void in_reverse(void*, std::size_t count, Task task, void* data) {
  for (std::size_t i = count; i > 0; --i) task(data, i - 1);
}

#if defined(__EMSCRIPTEN__) && !defined(__EMSCRIPTEN_PTHREADS__)  // there are no threads
constexpr auto on_threads = in_reverse;
#else
void on_threads(void*, std::size_t count, Task task, void* data) {
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < count; ++i) threads.emplace_back(task, data, i);
  for (std::thread& thread : threads) thread.join();
}
#endif

// Breaks the promise in ways that must not matter.
void past_the_end(void*, std::size_t count, Task task, void* data) {
  for (std::size_t i = 0; i < count; ++i) task(data, i), task(data, i);
  task(data, count);
  task(data, ~std::size_t{0});
}

// Breaks the promise in a way that leaves nothing to expect of the figures.
void never(void*, std::size_t, Task, void*) {}

struct Expected {
  std::vector<std::uint32_t> counts;
  std::vector<std::uint64_t> bits;
  std::vector<CrowdPair> pairs;
};

Expected expected_of(Case& c, const CrowdJob& job) {
  Expected expected;
  const std::size_t words = sc_pair_words(&c.asset);
  expected.bits.resize(job.instance_count * words);
  std::vector<Sphere> spheres(c.n);
  std::vector<Pair> pairs(c.n * c.n);
  for (std::size_t i = 0; i < job.instance_count; ++i) {
    if (job.pose.bones != nullptr) {
      RefitJob refit;
      refit.asset = &c.asset;
      refit.pose = job.pose;
      const std::size_t stride =
          job.instance_stride == 0 ? c.view().bone_count() * bone_stride(job.pose) : job.instance_stride;
      refit.pose.bones = job.pose.bones + i * (stride / sizeof(float));
      refit.radius = job.radius;
      refit.target = SC_TARGET_SCALAR;
      refit.spheres = spheres.data();
      refit.sphere_capacity = c.n;
      c.expect(refit.run() == SC_OK, "an instance's refit");
    } else {
      std::copy_n(job.spheres + i * (job.instance_stride == 0 ? c.n : job.instance_stride), c.n, spheres.begin());
    }
    DetectJob detect;
    detect.asset = &c.asset;
    detect.spheres = spheres.data();
    detect.sphere_count = c.n;
    detect.radius = job.radius;
    detect.target = SC_TARGET_SCALAR;
    const Filter filter{job.ignored_pairs, words};
    detect.filter = job.ignored_pairs == nullptr ? nullptr : &filter;
    detect.pairs = pairs.data();
    detect.pair_capacity = pairs.size();
    detect.bits = expected.bits.data() + i * words;
    detect.bit_words = words;
    c.expect(detect.run() == SC_OK, "an instance's detection");
    expected.counts.push_back(static_cast<std::uint32_t>(detect.pair_count));
    for (std::size_t k = 0; k < detect.pair_count; ++k) {
      expected.pairs.push_back({static_cast<std::uint32_t>(i), pairs[k]});
    }
  }
  return expected;
}

void draw_spheres(Case& c, CrowdJob& job) {
  const std::size_t strides[] = {0, c.n, c.n + 1, c.n + 3};
  job.instance_stride = c.random.pick(strides);
  const std::size_t stride = job.instance_stride == 0 ? c.n : job.instance_stride;
  const std::size_t count = job.instance_count == 0 ? 0 : (job.instance_count - 1) * stride + c.n;
  Sphere* const spheres = c.arena.add<Sphere>(count);
  fill_figures(c, &spheres->x, 4 * count);
  job.spheres = spheres;
}

void draw_instances(Case& c, CrowdJob& job) {
  const std::size_t bones = c.view().bone_count();
  job.pose.bone_layout = static_cast<MatrixLayout>(1 + c.random.below(4));
  job.pose.bone_stride = c.random.one_in(3) ? 0 : size_of(job.pose.bone_layout) + 4 * c.random.below(3);
  job.pose.bone_count = bones;
  const std::size_t own = (bones - 1) * bone_stride(job.pose) + size_of(job.pose.bone_layout);
  job.instance_stride = c.random.one_in(3) ? 0 : own + 4 * c.random.below(5);
  const std::size_t stride = job.instance_stride == 0 ? bones * bone_stride(job.pose) : job.instance_stride;
  const std::size_t floats = job.instance_count == 0 ? 0 : ((job.instance_count - 1) * stride + own) / sizeof(float);
  float* const matrices = c.arena.add<float>(floats);
  fill_figures(c, matrices, floats);
  job.pose.bones = matrices;
}

void draw_outputs(Case& c, CrowdJob& job, std::size_t there_are) {
  job.task_count = c.random.one_in(2) ? c.random.below(2) : 1 + c.random.below(7);
  job.scratch_words = sc_crowd_scratch_words(&c.asset, std::max<std::size_t>(job.task_count, 1)) + c.random.below(3);
  job.scratch = c.arena.add<std::uint64_t>(job.scratch_words);
  job.bit_words = c.random.one_in(2) ? job.instance_count * sc_pair_words(&c.asset) : 0;
  job.bits = c.arena.add<std::uint64_t>(job.bit_words);
  if (!c.random.one_in(3)) {
    job.count_capacity = job.instance_count + c.random.below(2);
    job.counts = c.arena.add<std::uint32_t>(job.count_capacity);
    job.pair_capacity = draw_capacity(c, there_are);
    job.pairs = c.arena.add<CrowdPair>(job.pair_capacity);
  }
  using Schedule = decltype(job.parallel_for);
  const Schedule schedules[] = {nullptr,      nullptr,
                                in_reverse,   c.random.one_in(4) ? never : in_reverse,
                                past_the_end, c.random.one_in(50) ? on_threads : in_reverse};
  job.parallel_for = c.random.pick(schedules);
}

Ways ways_of(Case& c, CrowdJob& job, Target& other) {
  const std::size_t words = sc_pair_words(&c.asset);
  Ways ways = {[&] {
                 const std::size_t counts[] = {power_of_two(32), 0xFFFFFFFFU, ~std::size_t{0}, power_of_two(58)};
                 job.instance_count = c.random.pick(counts);
                 c.spoil(SC_BAD_VALUE, SC_FIELD_INSTANCES);
               },
               [&] {
                 job.task_count = c.random.one_in(2) ? 0xFFFFFFFFU : ~std::size_t{0};
                 c.spoil(SC_BAD_VALUE, SC_FIELD_TASKS);
               },
               [&] { job.pose.vertices = c.arena.add<float>(3), c.spoil(SC_BAD_VALUE, SC_FIELD_VERTICES); },
               [&] { job.scratch = nullptr, c.spoil(SC_NULL, SC_FIELD_SCRATCH); },
               [&] { put_askew(c, job.scratch), c.spoil(SC_MISALIGNED, SC_FIELD_SCRATCH); },
               [&] {
                 job.scratch_words =
                     c.random.up_to(sc_crowd_scratch_words(&c.asset, std::max<std::size_t>(job.task_count, 1)) - 1);
                 c.spoil(SC_TOO_SMALL, SC_FIELD_SCRATCH);
               },
               [&] { job.counts = nullptr, job.count_capacity = 9, c.spoil(SC_NULL, SC_FIELD_COUNTS); },
               [&] {
                 job.counts = c.arena.add<std::uint32_t>(1);
                 job.count_capacity = c.random.up_to(std::min<std::size_t>(job.instance_count, 40) - 1);
                 c.spoil(SC_TOO_SMALL, SC_FIELD_COUNTS);
               },
               [&] {
                 job.counts = nullptr;
                 job.count_capacity = 0;
                 job.pairs = c.arena.add<CrowdPair>(1);
                 job.pair_capacity = 1;
                 c.spoil(SC_NULL, SC_FIELD_COUNTS);
               },
               [&, words] {
                 job.bits = c.arena.add<std::uint64_t>(1);
                 job.bit_words = job.instance_count * words + 1;
                 c.spoil(SC_BAD_VALUE, SC_FIELD_BITS);
               },
               [&] { job.bits = nullptr, job.bit_words = 1, c.spoil(SC_NULL, SC_FIELD_BITS); },
               [&] { job.radius = draw_none<Radius>(c, 2), c.spoil(SC_BAD_VALUE, SC_FIELD_RADIUS); },
               [&] { other = draw_none<Target>(c, 8), c.spoil(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET); },
               [&] {
                 if (job.ignored_pairs == nullptr) job.ignored_pairs = draw_filter(c).ignored;
                 put_askew(c, job.ignored_pairs);
                 c.spoil(SC_MISALIGNED, SC_FIELD_IGNORED_PAIRS);
               },
               [&] {
                 const Bytes read =
                     job.pose.bones != nullptr ? bytes_of(job.pose.bones, 12) : bytes_of(job.spheres, c.n);
                 if (put_over(c, job.scratch, read)) c.spoil(SC_ALIASED, SC_FIELD_OUTPUT);
               },
               [&] {
                 if (job.bit_words > 0 && put_over(c, job.bits, bytes_of(job.scratch, job.scratch_words))) {
                   c.spoil(SC_ALIASED, SC_FIELD_OUTPUT);
                 }
               }};
  add_asset_ways(c, job.asset, ways);
  if (job.pose.bones != nullptr) {
    ways.emplace_back([&] { job.spheres = c.arena.add<Sphere>(1), c.spoil(SC_BAD_VALUE, SC_FIELD_SPHERES); });
    ways.emplace_back([&] {
      const std::size_t strides[] = {44, 4 * c.n + 1, ~std::size_t{0}, power_of_two(62)};
      job.instance_stride = c.random.pick(strides);
      c.spoil(SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE);
    });
    add_bone_ways(c, job.pose, ways);
  } else {
    ways.emplace_back([&] { job.spheres = nullptr, c.spoil(SC_NULL, SC_FIELD_SPHERES); });
    ways.emplace_back([&] {
      if (c.n < 2) return;
      job.instance_stride = c.random.one_in(2) ? 1 + c.random.up_to(c.n - 2) : ~std::size_t{0};
      c.spoil(SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE);
    });
  }
  return ways;
}

void check_expected(Case& c, const CrowdJob& job, const Expected& expected, Status status) {
  const std::size_t there_are = expected.pairs.size(), listed = std::min(job.pair_capacity, there_are);
  const auto is_same = [](const CrowdPair& l, const CrowdPair& r) {
    return l.instance == r.instance && l.pair == r.pair;
  };
  c.expect(job.pair_count == there_are, "the count of pairs");
  c.expect((status == SC_OVERFLOW) == (job.pair_capacity > 0 && listed < there_are), "overflow");
  c.expect(job.count_capacity == 0 || std::equal(expected.counts.begin(), expected.counts.end(), job.counts),
           "the counts");
  c.expect(job.bit_words == 0 || std::equal(expected.bits.begin(), expected.bits.end(), job.bits), "the bits");
  c.expect(std::equal(job.pairs, job.pairs + listed, expected.pairs.begin(), is_same), "the pairs");
}

}  // namespace

void fuzz_crowd(Case& c) {
  if (!draw_asset(c)) {
    return;
  }
  CrowdJob job;
  job.asset = &c.asset;
  const std::size_t counts[] = {0, 1, 2, 5, 16, 17, 33};
  job.instance_count = c.n > 80 ? c.random.below(4) : c.random.pick(counts);
  job.radius = static_cast<Radius>(c.random.below(2));
  const bool moves = c.view().bone_count() > 0 && c.view().refit_rule() == RefitRule::kMoments;
  moves&& c.random.one_in(2) ? draw_instances(c, job) : draw_spheres(c, job);
  if (c.random.one_in(2)) job.ignored_pairs = draw_filter(c).ignored;
  const Expected expected = expected_of(c, job);
  draw_outputs(c, job, expected.pairs.size());
  const std::size_t instances = job.instance_count;
  const bool is_dealt = job.parallel_for != never;
  Target other = SC_TARGET_BEST;
  if (instances > 0) spoil_some(c, ways_of(c, job, other));
  job.pair_count = 77;

  Call call;
  call.writes_all = is_dealt;
  call.run = [&] {
    job.target = other == SC_TARGET_BEST ? draw_target(c) : other;
    return job.run();
  };
  call.outputs = [&] {
    return std::vector<Bytes>{bytes_of(job.counts, std::min(job.count_capacity, instances)),
                              bytes_of(job.bits, job.bit_words), bytes_of(job.pairs, job.pair_capacity),
                              bytes_of(job.scratch, job.scratch_words)};
  };
  // Figures that no task worked out are none.
  call.tidy = [&] {
    std::fill_n(job.scratch, job.scratch_words, std::uint64_t{0});
    if (!is_dealt) std::fill_n(job.counts, job.count_capacity, 0U);
    for (std::size_t i = job.pair_count; is_dealt && i < job.pair_capacity; ++i) job.pairs[i] = {};
  };
  const Status status = run_twice(c, call);
  if (status != SC_OK && status != SC_OVERFLOW) {
    c.expect(job.pair_count == 77, "a count of nothing");
  } else if (is_dealt) {
    check_expected(c, job, expected, status);
  }
}

}  // namespace spherechain::test
