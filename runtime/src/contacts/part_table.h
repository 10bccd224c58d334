// SPDX-License-Identifier: MIT
// A table with one entry for each pair of body parts.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "runtime/src/base/memory.h"
#include "spherechain/contacts.h"

namespace spherechain {

// Table of the pairs of body parts that are found: a bit and an entry for each two parts, in order.
template <class Entry>
struct TableOfParts {
  std::uint64_t* seen = nullptr;
  Entry* contacts = nullptr;
  std::size_t count_b = 0;  // parts of body b
  std::size_t word_count = 0;

  // Place of the pair a, b. In one body only pairs with a <= b have a place.
  std::size_t place(std::size_t a, std::size_t b, bool are_one) const {
    return a * count_b + b - (are_one ? a * (a + 1) / 2 : 0);
  }
  void take(WordMemory& memory, std::size_t count_a, std::size_t parts_of_b, bool are_one) {
    count_b = parts_of_b;
    const std::size_t pairs = are_one ? count_a * (count_a + 1) / 2 : count_a * count_b;
    word_count = (pairs + 63) / 64;
    memory.take(seen, word_count);
    memory.take(contacts, pairs);
  }
  void clear() const { std::fill_n(seen, word_count, std::uint64_t{0}); }
  // The entry; `is_new`: it holds nothing yet.
  Entry& at(std::size_t a, std::size_t b, bool are_one, bool& is_new) const {
    const std::size_t i = place(a, b, are_one);
    const std::uint64_t bit = std::uint64_t{1} << (i % 64);
    is_new = (seen[i / 64] & bit) == 0;
    seen[i / 64] |= bit;
    return contacts[i];
  }
};
using PartTable = TableOfParts<PartContact>;

}  // namespace spherechain
