// SPDX-License-Identifier: MIT
#include "spherechain/detect.h"

#include <algorithm>
#include <cfloat>

#include "arithmetic.h"
#include "simd.h"
#include "triangle_bits.h"

namespace spherechain {
namespace {

float squared_distance(const Sphere& p, const Sphere& q) {
  const float dx = p.x - q.x;
  const float dy = p.y - q.y;
  const float dz = p.z - q.z;
  return (dx * dx + dy * dy) + dz * dz;
}

// False for anything that is not finite: a NaN compares false, and an infinite d2 or s*s fails one of the two tests.
bool overlap(const Sphere& p, const Sphere& q) {
  const float s = p.radius + q.radius;
  const float squared_reach = s * s;
  return (squared_distance(p, q) < squared_reach) & (squared_reach <= FLT_MAX);
}

// For spheres that overlap, which are few: is the pair out of reach because it is nearly always that close? A reach
// below 1 only ever narrows the test above, also after rounding, so nothing is lost by testing that one first.
bool out_of_reach(Span<const NearPair> near, const Span<const Sphere>& spheres, const Pair& pair) {
  const NearPair* const found =
      std::lower_bound(near.begin(), near.end(), pair, [](const NearPair& n, const Pair& wanted) {
        return Pair{n.a, n.b} < wanted;
      });
  if (found == near.end() || found->a != pair.a || found->b != pair.b) {
    return false;
  }
  const Sphere& p = spheres[pair.a];
  const Sphere& q = spheres[pair.b];
  const float s = found->reach * (p.radius + q.radius);
  return !(squared_distance(p, q) < s * s);
}

// A list that counts on past its end.
template <typename T>
struct Output {
  Span<T> buffer;
  std::size_t count = 0;

  void add(const T& value) {
    if (count < buffer.size) {
      buffer[count] = value;
    }
    ++count;
  }
  // A caller who only wants the count brings no buffer.
  bool overflowed() const { return buffer.size > 0 && count > buffer.size; }
};

struct Result {
  Output<Pair> pairs;
  Output<ChainPair> chain_pairs;
  std::size_t tests = 0;
};

void detect_all(const Asset& asset, Span<const Sphere> spheres, Span<const NearPair> near, Result& result) {
  const auto n = static_cast<std::uint32_t>(asset.spheres().size);
  const Span<const std::uint64_t> ignored = asset.ignored();
  Output<Pair> pairs = result.pairs;
  for (std::uint32_t a = 0; a + 1 < n; ++a) {
    const Sphere p = spheres[a];
    for (std::uint32_t b = a + 1; b < n; ++b) {
      // Few spheres overlap, so whether the pair is ignored is asked last.
      if (overlap(p, spheres[b]) && !test_bit(ignored, ignored_bit(a, b)) && !out_of_reach(near, spheres, {a, b})) {
        pairs.add({a, b});
      }
    }
  }
  result.pairs = pairs;
  result.tests = pairs_of(n) - asset.ignored_count();
}

// Chain by chain; a bit in `seen` for each pair found, whatever the number of chains that hold it.
void detect_chains(const Asset& asset, Span<const Sphere> spheres, Span<const NearPair> near, Span<std::uint64_t> seen,
                   Result& result) {
  const std::size_t n = asset.spheres().size;
  const Span<const std::uint64_t> ignored = asset.ignored();
  std::size_t tests = 0;
  std::fill(seen.begin(), seen.end(), std::uint64_t{0});
  for (std::size_t c = 0; c < asset.chain_count(); ++c) {
    const Span<const std::uint32_t> members = asset.chain(c).spheres;
    for (std::size_t i = 0; i < members.size; ++i) {
      for (std::size_t j = i + 1; j < members.size; ++j) {
        const Pair pair{std::min(members[i], members[j]), std::max(members[i], members[j])};
        if (test_bit(ignored, ignored_bit(pair.a, pair.b))) {
          continue;
        }
        ++tests;
        if (overlap(spheres[pair.a], spheres[pair.b]) && !out_of_reach(near, spheres, pair)) {
          result.chain_pairs.add({static_cast<std::uint32_t>(c), pair});
          set_bit(seen, sorted_bit(pair.a, pair.b, n));
        }
      }
    }
  }
  result.tests = tests;
}

// The bits are in the order of sorted pairs, so they are read off upwards.
void list_pairs(Span<const std::uint64_t> seen, std::size_t n, Output<Pair>& pairs) {
  std::size_t a = 0;
  for (std::size_t w = 0; w < seen.size; ++w) {
    for (std::uint64_t word = seen[w]; word != 0; word &= word - 1) {
      const std::size_t bit = w * 64 + lowest_bit(word);
      while (bit >= row_begin(a + 1, n)) {
        ++a;
      }
      pairs.add({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(a + 1 + (bit - row_begin(a, n)))});
    }
  }
}

template <typename T>
bool is_missing(const Span<T>& span) {
  return span.data == nullptr && span.size > 0;
}

Status check(const DetectJob& job) {
  if (job.asset == nullptr || job.spheres.data == nullptr || is_missing(job.pairs)) {
    return Status::kNullArgument;
  }
  if (!job.asset->is_open()) {
    return Status::kNotOpen;
  }
  if ((job.radius != RadiusKind::kFit && job.radius != RadiusKind::kDetect) ||
      (job.method != Method::kM1 && job.method != Method::kM2)) {
    return Status::kBadArgument;
  }
  if (job.spheres.size < job.asset->spheres().size) {
    return Status::kTooFewSpheres;
  }
  Target resolved{};
  if (!resolve_target(job.target, resolved)) {
    return Status::kUnsupportedTarget;
  }
  if (job.method == Method::kM1) {
    if (job.context == nullptr || is_missing(job.context->words) || is_missing(job.chain_pairs)) {
      return Status::kNullArgument;
    }
    if (job.context->words.size < DetectContext::words_needed(*job.asset)) {
      return Status::kContextTooSmall;
    }
  }
  return Status::kOk;
}

}  // namespace

std::size_t DetectContext::words_needed(const Asset& asset) noexcept {
  return words_for(pairs_of(asset.spheres().size));
}

Status DetectJob::run() noexcept {
  const Status status = check(*this);
  if (status != Status::kOk) {
    return status;
  }
  const Span<const NearPair> near = asset->near_pairs(radius);
  Result result{{pairs}, {chain_pairs}};
  if (method == Method::kM1) {
    const Span<std::uint64_t> seen{context->words.data, DetectContext::words_needed(*asset)};
    detect_chains(*asset, spheres, near, seen, result);
    list_pairs({seen.data, seen.size}, asset->spheres().size, result.pairs);
    chain_pair_count = result.chain_pairs.count;
  } else {
    detect_all(*asset, spheres, near, result);
    chain_pair_count = result.pairs.count;
  }
  pair_count = result.pairs.count;
  test_count = result.tests;
  return result.pairs.overflowed() || result.chain_pairs.overflowed() ? Status::kOverflow : Status::kOk;
}

}  // namespace spherechain
