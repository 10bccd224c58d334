// SPDX-License-Identifier: MIT
// One hostile call: an asset, sound or changed at random, the memory of the call, and what is expected of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "arena.h"
#include "random.h"
#include "runtime/src/asset/asset_view.h"
#include "runtime/src/pairs/detect_job.h"
#include "runtime/src/penetrations/penetration_jobs.h"
#include "runtime/src/pose/pose.h"
#include "runtime/src/refit/refit_job.h"
#include "runtime/src/step/step_job.h"
#include "spherechain/spherechain.h"

namespace spherechain::test {

// A changed asset may ask for 2^32.
inline constexpr std::size_t kMaxVertices = 20000;

// How often calls ended how.
struct Tally {
  std::size_t ran = 0, overflowed = 0, refused = 0;
};

struct Case {
  Case(std::uint64_t seed, Arena& memory) : random(seed), arena(memory) { arena.begin(random); }
  const AssetView& view() const { return view_of(asset); }

  bool expect(bool holds, const char* what) {
    wrong = holds || wrong != nullptr ? wrong : what;
    return holds;
  }
  // Notes that the call is spoiled in a way that has to be refused so.
  void spoil(sc_code code, sc_field field) { ++spoiled, wanted = {code, field}; }

  Random random;
  Arena& arena;
  Asset asset, closed;
  Bytes asset_bytes;
  std::size_t n = 0;  // spheres
  std::size_t spoiled = 0;
  Status wanted{SC_OK, SC_FIELD_NONE};  // of the last way in which it is spoiled
  Tally tally;
  const char* wrong = nullptr;  // the first thing that was
};

// Gives the case an asset. False where the one drawn did not open, as it should.
bool draw_asset(Case& c);
std::size_t asset_count();

// From harmless to NaN, infinite, subnormal and huge: in some calls none, in some a few, in some all.
void fill_figures(Case& c, float* figures, std::size_t count);

// Draws a capacity: zero, too small, exact, or too large.
std::size_t draw_capacity(Case& c, std::size_t there_are);

Target draw_target(Case& c);
// A number that is none of an enum whose values are 0 to end - 1.
template <typename Enum>
Enum draw_none(Case& c, std::int32_t end) {
  const std::int32_t numbers[] = {end, -1, 255, 256, 257, 0x7FFFFFFF, -0x7FFFFFFF - 1, 0x10001};
  return static_cast<Enum>(c.random.pick(numbers));
}

// Matrices as many as the asset has bones, or some more, in any layout and stride; some with morph weights. The last
// matrix ends with its last element.
void draw_bones(Case& c, Pose& pose);
// False where the asset asks for too many.
bool draw_vertices(Case& c, Pose& pose);
// Joints with the names of the asset's bones, and sometimes one that differs.
std::vector<Bone> draw_engine_joints(Case& c);
// A sound filter; one that is empty has dirt for its pointers' target.
Filter draw_filter(Case& c);

// Ways to spoil a call; some do not apply, and then spoil nothing.
using Ways = std::vector<std::function<void()>>;
void add_bone_ways(Case& c, Pose& pose, Ways& ways);
void add_vertex_ways(Case& c, Pose& pose, Ways& ways);
void add_asset_ways(Case& c, const Asset*& asset, Ways& ways);
void spoil_filter(Case& c, Filter& filter);
// Takes none, one or two of them.
void spoil_some(Case& c, const Ways& ways);

// The same memory, askew: still inside the arena.
template <typename T>
void put_askew(Case& c, T*& data) {
  data = reinterpret_cast<T*>(reinterpret_cast<std::uintptr_t>(data) + 1 + c.random.below(alignof(T) - 1));
}

// `data` to somewhere inside what is read or written otherwise, aligned as T. False where that is nothing.
template <typename T>
bool put_over(Case& c, T*& data, Bytes other) {
  if (other.size == 0) {
    return false;
  }
  const std::uintptr_t place = reinterpret_cast<std::uintptr_t>(other.data) + c.random.up_to(other.size - 1);
  data = reinterpret_cast<T*>(place / alignof(T) * alignof(T));
  return true;
}

// A call and what it leaves.
struct Call {
  std::function<Status()> run;                  // on any target
  std::function<std::vector<Bytes>()> outputs;  // that a call which ran may write
  // Makes the outputs comparable: what is scratch, or past a count, becomes zero.
  std::function<void()> tidy = [] {};
  bool writes_all = true;  // all of the outputs: nothing may be left of what was there before
};

// Calls twice. The status must be the one wanted, a refusal must name its field, no other memory may change, and both
// calls must leave the same.
Status run_twice(Case& c, const Call& call);

// NaNs of all kinds are one, for which of them it is depends on the machine.
void make_one_nan(float* figures, std::size_t count);

void make_comparable(Penetration& one);
// A rule that every job refuses.
const Rule& bad_rule();

// Each makes one call and says in c.wrong what went wrong.
void fuzz_open(Case& c);
void fuzz_accessors(Case& c);
void fuzz_filter(Case& c);
void fuzz_prepare(Case& c);
void fuzz_binding(Case& c);
void fuzz_model(Case& c);
void fuzz_refit(Case& c);
void fuzz_detect(Case& c);
void fuzz_crowd(Case& c);
void fuzz_contacts(Case& c);
void fuzz_penetrations(Case& c);
void fuzz_bodies(Case& c);
void fuzz_steps(Case& c);
void fuzz_response(Case& c);

}  // namespace spherechain::test
