// SPDX-License-Identifier: MIT
// Which of a body's spheres have their centres inside another part of it, or inside another body? And which core points
// of parts that have such a sphere?
#pragma once

#include "runtime/src/base/filter.h"
#include "runtime/src/inside/inside.h"

namespace spherechain {

// Spheres of `body` in the skin of `skin`: of the same body, or of another. All is checked before.
struct InsideJob {
  JobBody body, skin;
  bool are_one = true;
  const Filter* filter = nullptr;  // of one body
  Target target{};
  Span<const Sphere> centers;        // of all of body's spheres, in the pose
  Span<const Pair> pairs;            // of one body: those that touch; other spheres are not looked at
  bool has_all_pairs = true;         // else all spheres are looked at
  std::uint64_t* scratch = nullptr;  // inside_scratch_words() of them
  Span<std::uint16_t> part;          // out: probe_count() of body's

  void run() const;
};

std::size_t inside_scratch_words(const AssetView& body, const AssetView& skin);

}  // namespace spherechain
