// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "baker/roles/names.h"

namespace spherechain::baker {

// All words are folded (letters.h), parts joined: "upperarm".

// The everyday name of the thing that a word means, in English and singular: "ear", "hair", "sword". Empty where the
// word means a part of the body, or nothing.
std::string_view thing_of(const std::u32string& word);

// The meaning of a word, kNone if it is unknown. A few short words count only beside a side: "main" is French for a
// hand.
Word word_of(const std::u32string& word, bool beside_side);

NamedSide side_of(const std::u32string& word);

// Abbreviations tell sides only where a rig has both of a pair: "g" and "d", "izq" and "der". The words that `word` may
// be paired with, and the side that `word` would then be. Empty where there are none.
struct SidedPair {
  std::u32string other;
  NamedSide side;
};
std::vector<SidedPair> pairs_with(const std::u32string& word);

// Words of sides that names begin or end with, without a separator: "linkerarm". The longest first.
const std::vector<std::u32string>& glued_sides();

Place place_of(const std::u32string& word);

enum class Section { kNone, kUpper, kLower };
Section section_of(const std::u32string& word);  // of an arm or a leg: "upper", "inferior", "下"

bool is_twist(const std::u32string& word);

// The length of the longest known word at `at` of a text without spaces, 0 where there is none.
std::size_t longest_word(const std::u32string& text, std::size_t at);

}  // namespace spherechain::baker
