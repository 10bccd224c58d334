// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace spherechain::baker {

// A letter of a name, without case, accents and marks: "É", "é" and "e" with a combining accent are one letter, as are
// full-width and plain Latin, katakana and hiragana, voiced and unvoiced kana. A Hangul syllable is its two or three
// jamo. Numbers and signs are separators, as are bytes that are no UTF-8.
struct Letter {
  enum class Kind { kSeparator, kSpelled, kUnspaced };  // unspaced: of a script that sets no spaces between words
  std::u32string folded;                                // one letter, or several: "ss", jamo
  Kind kind = Kind::kSeparator;
  bool is_upper = false, is_lower = false;
};

std::vector<Letter> letters_of(std::string_view name);

// All of a text folded, with separators left out.
std::u32string fold(std::string_view text);

std::string to_utf8(const std::u32string& text);

}  // namespace spherechain::baker
