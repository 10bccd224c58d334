// SPDX-License-Identifier: MIT
// How deep, which way out, how much, and what kind: of one body's contacts with itself, or of two bodies'.
#pragma once

#include "runtime/src/depth/sweep.h"
#include "spherechain/contacts.h"

namespace spherechain {

// Checked, but for its contacts.
struct Meeting {
  struct Side {
    const AssetView* asset;
    const Surface* surface;
    Pose pose;
  };
  Side a, b;  // of one body the same
  bool are_one;
  PairRule rule;
  Target target;  // resolved
  Span<const TriangleContact> contacts;
  Span<const Penetration> previous;
  bool quick, along;
  Rule limits;
  std::uint64_t* scratch;  // measure_words() of them
  Span<Penetration> out;
  std::uint32_t classes = ~std::uint32_t{0};  // a bit each: those that are listed and counted
  std::size_t kept = 0;                       // entries of `out` that are there already
  const std::uint16_t *inside_a = nullptr, *inside_b = nullptr;
  bool adds_enclosed = false;
  Span<const PartContact> met{};
  const std::uint64_t* part_pairs = nullptr;
};

// Is l worse than r? Faults first, by class, then the deeper one.
inline bool is_worse(const Penetration& l, const Penetration& r) {
  return l.kind != r.kind ? l.kind > r.kind : l.measures.depth > r.measures.depth;
}

// Adds a penetration, before which so many were found; where the list is full, in place of the least bad one.
void keep_worst(Span<Penetration> list, const Penetration& one, std::size_t count);

std::size_t measure_words(const AssetView& a, const AssetView& b, bool are_one, std::size_t contact_count);
// SC_OK, or SC_BAD_VALUE where one names a triangle that is in no body's skin.
Status check_contacts(const Meeting& meeting);
// SC_OK; or SC_OVERFLOW: the worst are there. Sorted by the two parts, the lesser number first. `count`: how many there
// are.
Status measure(const Meeting& meeting, std::size_t& count);

}  // namespace spherechain
