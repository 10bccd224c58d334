// SPDX-License-Identifier: MIT
// Detection, against the rule of its header pair by pair.
#include <algorithm>
#include <cfloat>
#include <set>

#include "fuzz_case.h"
#include "spherechain/detect.h"

namespace spherechain::test {
namespace {

struct Found {
  std::vector<Pair> pairs;
  std::vector<ChainPair> chain_pairs;
  std::size_t tests = 0;
};

class Rule {
 public:
  Rule(const Case& c, const DetectJob& job)
      : spheres_(job.spheres.data, job.spheres.data + c.n), reach_(c.n * c.n, -1.0F), out_(c.n * c.n) {
    const Filter* filter = job.filter;
    for (std::uint32_t i = 0; i < c.n; ++i) {
      if (filter == nullptr || filter->padding.size == 0) continue;
      spheres_[i].radius += filter->padding[i];
      if (spheres_[i].radius < 0) gone_.insert(i);
    }
    for (const NearPair& near : c.asset.near_pairs(job.radius)) {
      reach_[near.a * c.n + near.b] = near.reach;
    }
    const std::uint64_t* ignored = filter == nullptr ? c.asset.ignored().data : filter->ignored.data;
    std::size_t bit = 0;
    for (std::size_t b = 1; b < c.n; ++b) {
      for (std::size_t a = 0; a < b; ++a, ++bit) {
        const auto disabled = [&](std::size_t i) {
          return filter != nullptr && filter->disabled.size > 0 && (filter->disabled[i / 64] >> (i % 64) & 1) != 0;
        };
        out_[a * c.n + b] = (ignored[bit / 64] >> (bit % 64) & 1) != 0 || disabled(a) || disabled(b) ? 1 : 0;
      }
    }
  }

  bool is_out(std::size_t a, std::size_t b) const { return out_[a * spheres_.size() + b] != 0; }

  bool touch(std::size_t a, std::size_t b) const {
    if (gone_.count(a) + gone_.count(b) > 0) return false;
    const Sphere &p = spheres_[a], &q = spheres_[b];
    const float x = p.x - q.x, y = p.y - q.y, z = p.z - q.z, s = p.radius + q.radius;
    const float d2 = (x * x + y * y) + z * z;
    const float reach = reach_[a * spheres_.size() + b];
    const float t = reach * s;
    return d2 < s * s && s * s <= FLT_MAX && (reach < 0.0F || d2 < t * t);
  }

 private:
  std::vector<Sphere> spheres_;
  std::set<std::size_t> gone_;  // padded to below 0
  std::vector<float> reach_;
  std::vector<std::uint8_t> out_;
};

Found find(const Case& c, const DetectJob& job) {
  const Rule rule(c, job);
  Found found;
  const auto test = [&](std::uint32_t a, std::uint32_t b) {
    found.tests += rule.is_out(a, b) ? 0 : 1;
    return !rule.is_out(a, b) && rule.touch(a, b);
  };
  if (job.method == Method::kM2) {
    for (std::uint32_t a = 0; a < c.n; ++a) {
      for (std::uint32_t b = a + 1; b < c.n; ++b) {
        if (test(a, b)) found.pairs.push_back({a, b});
      }
    }
    return found;
  }
  for (std::uint32_t k = 0; k < c.asset.chain_count(); ++k) {
    const Span<const std::uint32_t> members = c.asset.chain(k).spheres;
    for (std::size_t i = 0; i < members.size; ++i) {
      for (std::size_t j = i + 1; j < members.size; ++j) {
        const Pair pair{std::min(members[i], members[j]), std::max(members[i], members[j])};
        if (test(pair.a, pair.b)) found.chain_pairs.push_back({k, pair}), found.pairs.push_back(pair);
      }
    }
  }
  std::sort(found.pairs.begin(), found.pairs.end());
  found.pairs.erase(std::unique(found.pairs.begin(), found.pairs.end()), found.pairs.end());
  return found;
}

struct DetectCall {
  DetectJob job;
  DetectContext context;
  DetectTable table;
  Filter filter;
  sc_detect_job c_job = SC_DETECT_JOB_INIT;
  sc_filter c_filter{};
};

void spoil_table(Case& c, DetectCall& call, std::uint32_t way, Spoiled& spoiled) {
  DetectJob& job = call.job;
  switch (way) {
    case 0:
      call.table.words.size = c.random.up_to(DetectTable::words_needed(c.asset) - 1);
      return spoiled.with(Status::kContextTooSmall);
    case 1:
      put_askew(c, call.table.words.data);
      return spoiled.with(Status::kMisaligned);
    case 2:
      // What it is of: a byte, for it may lie askew by now.
      reinterpret_cast<std::uint8_t*>(call.table.words.data)[sizeof(std::uint64_t) * c.random.below(5)] ^= 1;
      return spoiled.with(Status::kBadArgument);
    default:
      if (job.bits.size > 0) {
        put_over(c, job.bits.data, bytes_of(call.table.words.data, call.table.words.size));
        spoiled.with(Status::kSharedMemory);
      }
  }
}

void spoil_detect(Case& c, DetectCall& call, std::uint32_t way, Spoiled& spoiled) {
  DetectJob& job = call.job;
  const bool is_m1 = job.method == Method::kM1;
  const Bytes spheres = bytes_of(job.spheres.data, c.n);
  switch (way) {
    case 0:
    case 1:
      return spoil_asset(c, job, call.c_job, way, spoiled);
    case 2:
      job.spheres.data = nullptr;
      return spoiled.with(Status::kNullArgument);
    case 3:
      job.spheres.size = c.random.up_to(c.n - 1);
      return spoiled.with(Status::kTooFewSpheres);
    case 4:
      job.pairs = {nullptr, 1};
      return spoiled.with(Status::kNullArgument);
    case 5:
      job.bits = {nullptr, DetectJob::bit_words(c.asset) + 1};
      return spoiled.with(Status::kNullArgument);
    case 6:
      job.bits = {c.arena.add<std::uint64_t>(1), DetectJob::bit_words(c.asset) + 1};
      return spoiled.with(Status::kBadArgument);
    case 7:
      job.radius = draw_none<RadiusKind>(c, 2);
      call.c_job.radius = draw_c_none(c, 2);
      return spoiled.with(Status::kBadArgument);
    case 8:
      job.method = c.random.one_in(2) ? static_cast<Method>(0) : draw_none<Method>(c, 3);
      call.c_job.method = c.random.one_in(2) ? 0 : draw_c_none(c, 3);
      return spoiled.with(Status::kBadArgument);
    case 9:
      job.target = draw_none<Target>(c, 7);
      call.c_job.target = draw_c_none(c, 7);
      return spoiled.with(Status::kUnsupportedTarget);
    case 10:
      job.filter = &call.filter;
      if (call.filter.ignored.data == nullptr) call.filter = draw_filter(c);
      return spoil_filter(c, call.filter, spoiled);
    case 11:
      put_askew(c, job.spheres.data);
      return spoiled.with(Status::kMisaligned);
    case 12:
      job.pairs.data = c.arena.add<Pair>(job.pairs.size + 1);
      put_askew(c, job.pairs.data);
      return spoiled.with(Status::kMisaligned);
    case 13:
      if (job.bits.size > 0) {
        put_over(c, job.bits.data, spheres);
        spoiled.with(Status::kSharedMemory);
      }
      return;
    case 14:
      if (job.pairs.size > 0 && job.bits.size > 0) {
        put_over(c, job.pairs.data, bytes_of(job.bits.data, job.bits.size));
        spoiled.with(Status::kSharedMemory);
      } else if (job.pairs.size > 0) {
        put_over(c, job.pairs.data, spheres);
        spoiled.with(Status::kSharedMemory);
      }
      return;
    case 15:
      if (is_m1) {
        job.first_only = true;
        call.c_job.first_only = 7;
        spoiled.with(Status::kBadArgument);
      }
      return;
    case 16:
      if (is_m1) {
        job.context = nullptr;
        spoiled.with(Status::kNullArgument);
      }
      return;
    case 17:
      if (is_m1 && c.n > 1) {
        call.context.words.size = c.random.up_to(DetectContext::words_needed(c.asset) - 1);
        spoiled.with(Status::kContextTooSmall);
      }
      return;
    case 18:
      if (is_m1) {
        job.chain_pairs = {nullptr, 3};
        spoiled.with(Status::kNullArgument);
      }
      return;
    case 19:
      if (is_m1 && c.n > 1) {
        put_over(c, call.context.words.data, spheres);
        spoiled.with(Status::kSharedMemory);
      }
      return;
    default:
      return job.table == nullptr ? void() : spoil_table(c, call, way - 20, spoiled);
  }
}

void fill_in_c(const DetectCall& call, sc_detect_job& out) {
  const DetectJob& job = call.job;
  out.spheres = reinterpret_cast<const sc_sphere*>(job.spheres.data);
  out.sphere_count = job.spheres.size;
  out.filter = job.filter == nullptr ? nullptr : &call.c_filter;
  out.table = job.table == nullptr ? nullptr : call.table.words.data;
  out.table_words = call.table.words.size;
  out.scratch = job.context == nullptr ? nullptr : call.context.words.data;
  out.scratch_words = call.context.words.size;
  out.pairs = reinterpret_cast<sc_pair*>(job.pairs.data);
  out.pair_capacity = job.pairs.size;
  out.bits = job.bits.data;
  out.bit_words = job.bits.size;
  out.chain_pairs = reinterpret_cast<sc_chain_pair*>(job.chain_pairs.data);
  out.chain_pair_capacity = job.chain_pairs.size;
}

// The counts and outputs of a job that ran are the rule's.
void check_found(Case& c, const DetectJob& job, const Found& found, Status status) {
  const std::size_t there_are = job.first_only ? std::min<std::size_t>(1, found.pairs.size()) : found.pairs.size();
  const bool is_m1 = job.method == Method::kM1;
  const bool too_small = (job.pairs.size > 0 && job.pairs.size < there_are) ||
                         (is_m1 && job.chain_pairs.size > 0 && job.chain_pairs.size < found.chain_pairs.size());
  c.expect((status == Status::kOverflow) == too_small, "overflow");
  c.expect(job.pair_count == there_are, "the count of pairs");
  c.expect(job.chain_pair_count == (is_m1 ? found.chain_pairs.size() : there_are), "the count of chain pairs");
  c.expect(job.first_only ? job.test_count <= found.tests : job.test_count == found.tests, "the count of tests");
  c.expect(std::equal(job.pairs.begin(), job.pairs.begin() + std::min(job.pairs.size, there_are), found.pairs.begin()),
           "the pairs");
  for (std::size_t i = 0; is_m1 && i < std::min(job.chain_pairs.size, found.chain_pairs.size()); ++i) {
    c.expect(
        job.chain_pairs[i].chain == found.chain_pairs[i].chain && job.chain_pairs[i].pair == found.chain_pairs[i].pair,
        "the chain pairs");
  }
  std::vector<std::uint64_t> bits(job.bits.size);
  for (std::size_t i = 0; i < there_are && !bits.empty(); ++i) {
    const std::size_t b = found.pairs[i].b, bit = b * (b - 1) / 2 + found.pairs[i].a;
    bits[bit / 64] |= std::uint64_t{1} << (bit % 64);
  }
  c.expect(std::equal(bits.begin(), bits.end(), job.bits.begin()), "the bits");
}

}  // namespace

void fuzz_detect(Case& c) {
  if (!draw_asset(c)) {
    return;
  }
  DetectCall call;
  DetectJob& job = call.job;
  job.asset = &c.asset;
  Sphere* spheres = c.arena.add<Sphere>(c.n);
  fill_figures(c, &spheres->x, 4 * c.n);
  job.spheres = {spheres, c.n + (c.random.one_in(4) ? 5 : 0)};  // more are not looked at
  job.radius = static_cast<RadiusKind>(c.random.below(2));
  job.method = static_cast<Method>(1 + c.random.below(2));
  job.target = draw_target(c);
  if (c.random.one_in(2)) {
    call.filter = draw_filter(c);
    job.filter = &call.filter;
  }
  if (c.random.one_in(2)) {
    call.table.words.size = DetectTable::words_needed(c.asset);
    call.table.words.data = c.arena.add<std::uint64_t>(call.table.words.size);
    c.expect(prepare_detect(c.asset, job.radius, job.filter, call.table) == Status::kOk, "a table");
    job.table = &call.table;
  }
  const Found found = find(c, job);
  const bool is_m1 = job.method == Method::kM1;
  job.first_only = !is_m1 && c.random.one_in(4);
  job.pairs.size = draw_capacity(c, found.pairs.size());
  job.pairs.data = c.arena.add<Pair>(job.pairs.size);
  job.bits.size = c.random.one_in(2) ? DetectJob::bit_words(c.asset) : 0;
  job.bits.data = c.arena.add<std::uint64_t>(job.bits.size);
  if (is_m1 || c.random.one_in(8)) {
    call.context.words.size = DetectContext::words_needed(c.asset) + c.random.below(2);
    call.context.words.data = c.arena.add<std::uint64_t>(call.context.words.size);
    job.context = &call.context;
    job.chain_pairs.size = draw_capacity(c, found.chain_pairs.size());
    job.chain_pairs.data = c.arena.add<ChainPair>(job.chain_pairs.size);
  }
  call.c_job.asset = c.c_asset;
  call.c_job.radius = static_cast<sc_radius>(job.radius);
  call.c_job.method = static_cast<sc_method>(job.method);
  call.c_job.target = static_cast<sc_target>(draw_target(c));
  call.c_job.first_only = job.first_only ? 1 : 0;
  Spoiled spoiled;
  spoil_some(c, 24, [&](std::uint32_t way) { spoil_detect(c, call, way, spoiled); });
  call.c_filter = to_c(call.filter);
  fill_in_c(call, call.c_job);
  job.pair_count = job.chain_pair_count = job.test_count = 77;
  call.c_job.pair_count = call.c_job.chain_pair_count = call.c_job.test_count = 77;

  run_both(
      c, spoiled,
      [&] {
        const Status status = job.run();
        if (status == Status::kOk || status == Status::kOverflow) {
          check_found(c, job, found, status);
        } else {
          c.expect(job.pair_count == 77 && job.chain_pair_count == 77 && job.test_count == 77, "a count of nothing");
        }
        return status;
      },
      [&] { return sc_detect(&call.c_job); },
      [&](Status) {
        std::vector<Bytes> written{bytes_of(job.pairs.data, std::min(job.pairs.size, job.pair_count)),
                                   bytes_of(job.bits.data, job.bits.size)};
        if (is_m1) {
          written.push_back(bytes_of(job.chain_pairs.data, std::min(job.chain_pairs.size, job.chain_pair_count)));
          written.push_back(bytes_of(call.context.words.data, DetectContext::words_needed(c.asset)));
        }
        return written;
      },
      [&](bool ran) {
        if (ran && is_m1) std::fill(call.context.words.begin(), call.context.words.end(), std::uint64_t{0});  // scratch
      });
  c.expect(call.c_job.pair_count == job.pair_count && call.c_job.chain_pair_count == job.chain_pair_count &&
               call.c_job.test_count == job.test_count,
           "the C API counts something else");
}

}  // namespace spherechain::test
