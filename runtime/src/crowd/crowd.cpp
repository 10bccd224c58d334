// SPDX-License-Identifier: MIT
#include "spherechain/crowd.h"

#include <algorithm>
#include <cstring>

#include "runtime/src/base/arithmetic.h"
#include "runtime/src/base/pair_bits.h"
#include "runtime/src/base/sized.h"
#include "runtime/src/base/status.h"
#include "runtime/src/crowd/checks.h"
#include "runtime/src/crowd/lanes.h"
#include "runtime/src/simd/simd.h"

namespace spherechain {

SPHERECHAIN_LAST_FIELD(sc_crowd_job, pair_count);

namespace {

constexpr std::size_t kAlignmentWords = 8;  // a cache line, and what a wide register wants

// Where in the context's words what is kept.
struct Layout {
  explicit Layout(const AssetView& asset)
      : bit_words(words_for(pairs_of(asset.spheres().size))),
        lane_words(asset.spheres().size * kLaneFigures * kMaxLanes / 2),
        bone_words(asset.bone_count() * kMatrixFloats * kMaxLanes / 2),
        product_words(product_floats(asset.moment_tables()) / 2),
        candidate_words(candidate_places(asset.spheres().size) / 4 + 1),
        order_words(1 + asset.spheres().size / 2 + 1) {}

  std::size_t bit_words;
  std::size_t lane_words;       // a task
  std::size_t bone_words;       // a task: matrices, one instance a lane
  std::size_t product_words;    // a task: of matrices
  std::size_t candidate_words;  // a task
  std::size_t order_words;      // a task: its total, and a place a sphere
  std::size_t task_words() const {
    return kAlignmentWords + lane_words + bone_words + product_words + kMaxLanes * bit_words + candidate_words +
           order_words;
  }
  std::size_t shared_words() const { return 2 * bit_words; }
};

struct Crowd {
  const CrowdJob& job;
  const AssetView& asset;
  Layout layout;
  Target target;                          // resolved
  std::size_t stride, lanes, task_count;  // of spheres; of the target; of the job
  Span<const RestPair> rest_pairs;
  Span<std::uint64_t> wanted, is_rest_pair;  // bits in the order of sorted pairs
  RefitInputs bones = {};                    // where the job has bones
  bool list_only = false;                    // the second pass

  // Start of a task's share of job.pairs. The task lists its pairs there until all totals are known.
  std::size_t list_begin(std::size_t task) const { return job.pair_capacity / task_count * task; }
  std::size_t list_end(std::size_t task) const {
    return task + 1 == task_count || list_only ? job.pair_capacity : list_begin(task + 1);
  }

  std::uint64_t* scratch_of(std::size_t task) const {
    return job.scratch + layout.shared_words() + task * layout.task_words();
  }
  // Whole batches, so that the tasks' number is of no consequence.
  std::size_t first_of(std::size_t task) const {
    const std::size_t batches = (job.instance_count + lanes - 1) / lanes;
    return std::min(job.instance_count,
                    batches / task_count * task * lanes + std::min(task, batches % task_count) * lanes);
  }
  // Number of pairs that a task found. The task must have run.
  std::size_t pairs_of(std::size_t task) const { return static_cast<std::size_t>(scratch_of(task)[0]); }
  std::size_t pairs_before(std::size_t task) const {
    std::size_t sum = 0;
    for (std::size_t i = 0; i < task; ++i) {
      sum += pairs_of(i);
    }
    return sum;
  }
};

// Which pairs are to be tested, and which are rest pairs.
void choose_pairs(Crowd& crowd) {
  const CrowdJob& job = crowd.job;
  const std::size_t n = crowd.asset.spheres().size;
  const Span<const std::uint64_t> own = crowd.asset.ignored();
  const Span<const std::uint64_t> ignored =
      job.ignored_pairs == nullptr ? own : Span<const std::uint64_t>{job.ignored_pairs, own.size};
  std::fill(crowd.wanted.begin(), crowd.wanted.end(), ~std::uint64_t{0});
  std::fill(crowd.is_rest_pair.begin(), crowd.is_rest_pair.end(), std::uint64_t{0});
  for_each_pair(ignored.data, n, [&](std::uint32_t a, std::uint32_t b) {  // few
    assign_bit(crowd.wanted, sorted_bit(a, b, n), false);
  });
  for (const RestPair& pair : crowd.rest_pairs) {
    set_bit(crowd.is_rest_pair, sorted_bit(pair.a, pair.b, n));
  }
}

// One instance's pairs into `pairs` from place `at` on, as far as they fit: a counting sort, for the table's order is
// by the larger sphere.
void list_instance(const std::uint64_t* bits, const Crowd& crowd, std::size_t instance, std::size_t at,
                   Span<CrowdPair> pairs, std::uint32_t* places) {
  const std::size_t n = crowd.asset.spheres().size;
  std::fill(places, places + n, 0U);
  for_each_pair(bits, n, [&](std::uint32_t a, std::uint32_t) { ++places[a]; });
  std::uint32_t before = 0;
  for (std::size_t a = 0; a < n; ++a) {
    const std::uint32_t count = places[a];
    places[a] = before;
    before += count;
  }
  for_each_pair(bits, n, [&](std::uint32_t a, std::uint32_t b) {
    const std::size_t place = at + places[a]++;
    if (place < pairs.size) {
      pairs[place] = {static_cast<std::uint32_t>(instance), {a, b}};
    }
  });
}

// The same out of a list that is in order.
void list_found(const std::uint32_t* listed, std::size_t count, std::uint32_t instance, std::size_t at,
                Span<CrowdPair> pairs) {
  const std::size_t room = at < pairs.size ? pairs.size - at : 0;
  for (std::size_t i = 0; i < count && i < room; ++i) {
    pairs[at + i] = {instance, {listed[i] >> 16, listed[i] & 0xFFFFU}};
  }
}

// Which body parts one instance's pairs are of. `bits` of its spheres, or those that are listed.
void mark_parts(const Crowd& crowd, const std::uint64_t* bits, const std::uint32_t* listed, std::size_t count,
                std::uint64_t* out) {
  const Span<const RestSphere> spheres = crowd.asset.spheres();
  const std::size_t parts = crowd.asset.part_count();
  std::fill(out, out + part_pair_words(crowd.asset), std::uint64_t{0});
  const auto mark = [&](std::uint32_t a, std::uint32_t b) {
    const std::size_t p = spheres[a].part, q = spheres[b].part, bit = std::min(p, q) * parts + std::max(p, q);
    out[bit / 64] |= std::uint64_t{1} << bit % 64;
  };
  if (count > kMaxListed) {
    for_each_pair(bits, spheres.size, mark);
  } else {
    std::for_each(listed, listed + count, [&](std::uint32_t pair) { mark(pair >> 16, pair & 0xFFFFU); });
  }
}

// A task's instances, a register's lanes at a time.
void run_task(void* data, std::size_t task) {
  const Crowd& crowd = *static_cast<const Crowd*>(data);
  if (task >= crowd.task_count) {
    return;
  }
  const CrowdJob& job = crowd.job;
  const std::size_t words = crowd.layout.bit_words;
  std::uint64_t* scratch = crowd.scratch_of(task);
  auto* places = reinterpret_cast<std::uint32_t*>(scratch + 1);
  auto* candidates = reinterpret_cast<std::uint16_t*>(scratch + crowd.layout.order_words);
  std::uint64_t* own_bits = scratch + crowd.layout.order_words + crowd.layout.candidate_words;
  const auto unaligned = reinterpret_cast<std::uintptr_t>(own_bits + kMaxLanes * words);
  constexpr std::uintptr_t kAlignment = 8 * kAlignmentWords;

  LaneBatch batch;
  batch.stride = crowd.stride;
  batch.sphere_count = crowd.asset.spheres().size;
  batch.wanted = crowd.wanted.data;
  batch.is_rest_pair = crowd.is_rest_pair.data;
  batch.rest_pairs = crowd.rest_pairs;
  batch.lanes = reinterpret_cast<float*>((unaligned + kAlignment - 1) / kAlignment * kAlignment);
  batch.bit_words = words;
  batch.candidates = candidates;

  LaneRefit refit;
  refit.inputs = crowd.bones;
  refit.instance_stride = job.pose.bones == nullptr ? 0 : bone_stride(crowd.asset, job) / sizeof(float);
  refit.lanes = batch.lanes;
  refit.matrices = batch.lanes + 2 * crowd.layout.lane_words;
  refit.products = refit.matrices + 2 * crowd.layout.bone_words;

  const bool lists = job.pair_capacity > 0;
  const Span<CrowdPair> pairs{job.pairs, crowd.list_end(task)};
  const std::size_t end = crowd.first_of(task + 1);
  std::uint64_t total = 0;
  std::size_t place = crowd.list_only ? crowd.pairs_before(task) : crowd.list_begin(task);
  // An instance of more pairs than are listed has them listed from bits: kept once they are wanted, for a crowd's poses
  // are alike.
  bool keeps_bits = job.bit_words > 0;
  for (std::size_t first = crowd.first_of(task); first < end; first += crowd.lanes) {
    batch.spheres = job.pose.bones != nullptr ? nullptr : job.spheres + first * crowd.stride;
    refit.count = batch.count = std::min(crowd.lanes, end - first);
    refit.next_count = std::min(crowd.lanes, end - first - batch.count);
    std::uint64_t* const bits = job.bit_words > 0 ? job.bits + first * words : own_bits;
    const auto find = [&] {
      if (job.pose.bones != nullptr) {
        refit.inputs.matrices = job.pose.bones + first * refit.instance_stride;
        refit_lanes(crowd.target, refit);
      }
      batch.bits = keeps_bits ? bits : nullptr;
      if (keeps_bits) {
        std::fill(bits, bits + batch.count * words, std::uint64_t{0});
      }
      test_lanes(crowd.target, batch);
    };
    find();
    if ((lists || job.part_pair_words > 0) && !keeps_bits &&
        *std::max_element(batch.pair_counts, batch.pair_counts + batch.count) > kMaxListed) {
      keeps_bits = true;
      find();
    }
    for (std::size_t lane = 0; lane < batch.count; ++lane) {
      const std::uint32_t instance = static_cast<std::uint32_t>(first + lane), own = batch.pair_counts[lane];
      total += own;
      if (job.counts != nullptr) {
        job.counts[instance] = own;
      }
      if (job.part_pair_words > 0 && !crowd.list_only) {
        mark_parts(crowd, bits + lane * words, batch.listed[lane], own,
                   job.part_pairs + instance * part_pair_words(crowd.asset));
      }
      if (lists && own > 0) {
        if (own <= kMaxListed) {
          list_found(batch.listed[lane], own, instance, place, pairs);
        } else {
          list_instance(bits + lane * words, crowd, instance, place, pairs, places);
        }
        place += own;
      }
    }
  }
  if (!crowd.list_only) {
    scratch[0] = total;
  }
}

void run_tasks(Crowd& crowd) {
  if (crowd.job.parallel_for != nullptr) {
    crowd.job.parallel_for(crowd.job.user, crowd.task_count, run_task, &crowd);
    return;
  }
  for (std::size_t task = 0; task < crowd.task_count; ++task) {
    run_task(&crowd, task);
  }
}

// Brings the shares together. False where a task had more pairs than its share has room for.
bool join_lists(const Crowd& crowd) {
  for (std::size_t task = 0; task < crowd.task_count; ++task) {
    if (crowd.pairs_of(task) > crowd.list_end(task) - crowd.list_begin(task)) {
      return false;
    }
  }
  CrowdPair* to = crowd.job.pairs;
  for (std::size_t task = 0; task < crowd.task_count; ++task) {
    const std::size_t count = crowd.pairs_of(task);
    std::memmove(to, crowd.job.pairs + crowd.list_begin(task), count * sizeof(CrowdPair));
    to += count;
  }
  return true;
}

}  // namespace

}  // namespace spherechain

using namespace spherechain;

extern "C" {

size_t sc_crowd_scratch_words(const sc_asset* asset, size_t task_count) noexcept {
  if (!is_open(asset)) {
    return 0;
  }
  const Layout layout(view_of(*asset));
  return layout.shared_words() + (task_count == 0 ? 1 : task_count) * layout.task_words();
}

sc_status sc_detect_crowd(sc_crowd_job* given) noexcept {
  if (given == nullptr) {
    return refuse(SC_NULL, SC_FIELD_NONE);
  }
  sc_crowd_job job{};
  const Status known = read_struct(given, job);
  if (known != SC_OK) {
    return known;
  }
  if (!is_open(job.asset)) {
    return refuse(job.asset == nullptr ? SC_NULL : SC_NOT_OPEN, SC_FIELD_ASSET);
  }
  const AssetView& asset = view_of(*job.asset);
  const Status status = check_crowd(asset, job);
  if (status != SC_OK) {
    return status;
  }
  Target resolved{};
  if (!resolve_target(job.target, resolved)) {
    return refuse(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET);
  }
  const Layout layout(asset);
  Crowd crowd{job,
              asset,
              layout,
              resolved,
              job.spheres == nullptr ? 0 : sphere_stride(asset, job),
              lanes_of(resolved),
              task_count(job),
              asset.rest_pairs(job.radius),
              {job.scratch, layout.bit_words},
              {job.scratch + layout.bit_words, layout.bit_words}};
  if (job.pose.bones != nullptr && job.instance_count > 0) {
    crowd.bones = refit_inputs(asset, job.pose, job.radius);
  }
  choose_pairs(crowd);
  for (std::size_t task = 0; task < crowd.task_count; ++task) {
    crowd.scratch_of(task)[0] = 0;
  }
  run_tasks(crowd);
  given->pair_count = job.pair_count = crowd.pairs_before(crowd.task_count);
  if (job.pair_capacity > 0 && crowd.task_count > 1 && !join_lists(crowd)) {
    crowd.list_only = true;
    run_tasks(crowd);
  }
  return job.pair_capacity > 0 && job.pair_count > job.pair_capacity ? refuse(SC_OVERFLOW, SC_FIELD_PAIRS) : done();
}

}  // extern "C"
