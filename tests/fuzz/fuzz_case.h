// SPDX-License-Identifier: MIT
// One hostile call: an asset, sound or changed at random, the memory of the call, and what is expected of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "arena.h"
#include "random.h"
#include "spherechain/asset.h"
#include "spherechain/filter.h"
#include "spherechain/refit_bones.h"
#include "spherechain/simd.h"
#include "spherechain/spherechain.h"

namespace spherechain::test {

// A changed asset may ask for 2^32.
inline constexpr std::size_t kMostVertices = 20000;

// How often calls ended how.
struct Tally {
  std::size_t ran = 0, overflowed = 0, refused = 0;
};

struct Case {
  Case(std::uint64_t seed, Arena& arena) : random(seed), arena(arena) { arena.begin(random); }

  Random random;
  Arena& arena;
  Asset asset;                        // open
  const sc_asset* c_asset = nullptr;  // the same
  Asset closed;
  const sc_asset* c_closed = nullptr;
  std::size_t n = 0;  // spheres
  Tally tally;
  const char* wrong = nullptr;  // the first thing that was

  bool expect(bool holds, const char* what) {
    wrong = holds || wrong != nullptr ? wrong : what;
    return holds;
  }
};

// Gives the case an asset. False where the one drawn did not open, as it should.
bool draw_asset(Case& c);
std::size_t asset_count();

// From harmless to NaN, infinite, subnormal and huge: in some calls none, in some a few, in some all.
void fill_figures(Case& c, float* figures, std::size_t count);

// None, fewer than there are, exactly as many, more.
std::size_t draw_capacity(Case& c, std::size_t there_are);

// A supported one, and an argument that is none.
Target draw_target(Case& c);
template <typename Enum>
Enum draw_none(Case& c, unsigned first) {
  return static_cast<Enum>(first + c.random.below(256 - first));
}
inline std::int32_t draw_c_none(Case& c, std::int32_t first) {
  const std::int32_t numbers[] = {first, -1, 255, 256, 257, 0x7FFFFFFF, -0x7FFFFFFF - 1, 0x10001};
  return c.random.pick(numbers);
}

// As many as the asset has bones, or some more, in any layout and stride; the last one ends with its last element.
BoneMatrices draw_bones(Case& c);

// The same memory, askew: still inside the arena.
template <typename T>
void put_askew(Case& c, T*& data) {
  data = reinterpret_cast<T*>(reinterpret_cast<std::uintptr_t>(data) + 1 + c.random.below(alignof(T) - 1));
}

// `data` to somewhere inside what is read or written otherwise, aligned as T.
template <typename T>
void put_over(Case& c, T*& data, Bytes other) {
  if (other.size == 0) {
    return;
  }
  const std::uintptr_t place = reinterpret_cast<std::uintptr_t>(other.data) + c.random.up_to(other.size - 1);
  data = reinterpret_cast<T*>(place / alignof(T) * alignof(T));
}

// What is wrong with a call, on purpose.
struct Spoiled {
  std::size_t count = 0;
  Status status = Status::kOk;  // of the last one
  void with(Status wanted) { ++count, status = wanted; }
};

// Calls spoil(k) for no, one or two k below `ways`.
template <typename Spoil>
void spoil_some(Case& c, std::uint32_t ways, const Spoil& spoil) {
  const std::uint32_t times = c.random.one_in(2) ? 0 : c.random.one_in(5) ? 2 : 1;
  const std::uint32_t first = c.random.below(ways);
  for (std::uint32_t i = 0; i < times; ++i) {
    spoil(i == 0 ? first : (first + 1 + c.random.below(ways - 1)) % ways);
  }
}

// Ways 0 and 1 of any job: no asset, one that is not open.
template <typename Job, typename CJob>
void spoil_asset(Case& c, Job& job, CJob& c_job, std::uint32_t way, Spoiled& spoiled) {
  job.asset = way == 0 ? nullptr : &c.closed;
  c_job.asset = way == 0 ? nullptr : c.c_closed;
  spoiled.with(way == 0 ? Status::kNullArgument : Status::kNotOpen);
}

// A sound filter, its buffers in the arena; one that is empty has dirt for its pointer's target.
Filter draw_filter(Case& c);
constexpr std::uint32_t kFilterWays = 8;
void spoil_filter(Case& c, Filter& filter, Spoiled& spoiled);
sc_filter to_c(const Filter& filter);

// Runs `cpp` and then `c_api`, which return statuses of the same call and write `outputs`, of which some may come to be
// written. Checks the statuses against `spoiled`, all other memory against the picture, and the outputs of both, after
// tidy(), against each other; `writes_all`: of the outputs, so that neither may leave there what was before.
template <typename Cpp, typename CApi, typename Writable, typename Tidy>
Status run_both(Case& c, const Spoiled& spoiled, const Cpp& cpp, const CApi& c_api, const Writable& writable,
                const Tidy& tidy, bool writes_all = true) {
  const auto copy = [&](const std::vector<Bytes>& ranges) {
    std::vector<std::uint8_t> bytes;
    for (const Bytes& range : ranges) {
      const auto* data = static_cast<const std::uint8_t*>(range.data);
      bytes.insert(bytes.end(), data, data + range.size);
    }
    return bytes;
  };
  c.arena.seal();
  const Status status = cpp();
  const bool ran = status == Status::kOk || status == Status::kOverflow;
  c.expect(spoiled.count == 0 ? ran : spoiled.count == 1 ? status == spoiled.status : !ran, "another status");
  const std::vector<Bytes> changed = ran ? writable(status) : std::vector<Bytes>();
  c.expect(c.arena.kept_but(changed), "memory was written that must not be");
  tidy(ran);
  const std::vector<std::uint8_t> outputs = copy(changed);
  c.arena.restore();
  if (writes_all) c.arena.invert(changed);
  c.expect(static_cast<Status>(c_api()) == status, "the C API says something else");
  c.expect(c.arena.kept_but(changed), "the C API wrote memory that must not be");
  tidy(ran);
  c.expect(copy(changed) == outputs, "the C API, or another target, gives something else");
  (ran ? status == Status::kOk ? c.tally.ran : c.tally.overflowed : c.tally.refused) += 1;
  return status;
}

// NaNs of all kinds are one, for which of them it is depends on the machine.
void make_one_nan(float* figures, std::size_t count);

// Each makes one call and says in c.wrong what went wrong.
void fuzz_open(Case& c);
void fuzz_accessors(Case& c);
void fuzz_refit(Case& c);
void fuzz_refit_bones(Case& c);
void fuzz_cover(Case& c);
void fuzz_skin(Case& c);
void fuzz_filter(Case& c);
void fuzz_detect(Case& c);
void fuzz_contacts(Case& c);
void fuzz_crowd(Case& c);
void fuzz_triangle_contacts(Case& c);
void fuzz_detect_skin(Case& c);
void fuzz_confirm(Case& c);

}  // namespace spherechain::test
