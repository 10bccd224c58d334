// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/roles/letters.h"

#include <optional>

#include "baker/mesh/utf8.h"

namespace spherechain::baker {
namespace {

using Kind = Letter::Kind;

constexpr char32_t kBroken = 0xFFFD;

// The code point at `at`, which moves on. One byte that is no UTF-8 is kBroken.
char32_t next_code_point(std::string_view text, std::size_t& at) {
  const std::optional<CodePoint> point = first_code_point(text.substr(at));
  at += point ? point->length : 1;
  return point ? char32_t{point->code} : kBroken;
}

// U+00C0 to U+017F without accents.
constexpr std::string_view kLatin =
    "aaaaaaaceeeeiiiidnooooo ouuuuytsaaaaaaaceeeeiiiidnooooo ouuuuytyaaaaaaccccccccddddeeeeeeeeeegggggggghhhhiiiiiiiiii"
    "iijjkkkllllllllllnnnnnnnnnoooooooorrrrrrssssssssttttttuuuuuuuuuuuuwwyyyzzzzzzs";

// Hiragana and katakana as unvoiced hiragana.
char32_t fold_kana(char32_t c) {
  if (c >= 0x30A1 && c <= 0x30F6) c -= 0x60;
  if (c == 0x3094) return 0x3046;
  if (c >= 0x304C && c <= 0x3062 && c % 2 == 0) return c - 1;
  if (c == 0x3065 || c == 0x3067 || c == 0x3069) return c - 1;
  if (c >= 0x306F && c <= 0x307D) return c - (c - 0x306F) % 3;
  return c;
}

bool is_combining(char32_t c) { return (c >= 0x300 && c <= 0x36F) || c == 0x3099 || c == 0x309A; }

Letter letter_of(char32_t c) {
  if (c >= 0xFF01 && c <= 0xFF5E) c -= 0xFEE0;  // full width
  const auto spelled = [](std::u32string folded, bool upper, bool lower) {
    return Letter{std::move(folded), Kind::kSpelled, upper, lower};
  };
  if (c >= 'a' && c <= 'z') return spelled({c}, false, true);
  if (c >= 'A' && c <= 'Z') return spelled({c + 32}, true, false);
  if (c == 0xDF) return spelled(U"ss", false, true);
  if (c >= 0xC0 && c < 0xC0 + kLatin.size() && kLatin[c - 0xC0] != ' ') {
    const bool upper = c < 0xDF || (c >= 0x100 && (c < 0x139 || (c > 0x148 && c < 0x178)) && c % 2 == 0) ||
                       (c >= 0x139 && c <= 0x148 && c % 2 == 1) || (c >= 0x178 && c % 2 == 1 && c < 0x17F);
    return spelled({static_cast<char32_t>(kLatin[c - 0xC0])}, upper, !upper);
  }
  if (c >= 0x400 && c <= 0x42F) {  // Cyrillic capitals
    c = c < 0x410 ? c + 0x50 : c + 0x20;
    return spelled({c == 0x451 ? char32_t{0x435} : c == 0x439 ? char32_t{0x438} : c}, true, false);
  }
  if (c >= 0x430 && c <= 0x45F) {
    return spelled({c == 0x451 ? char32_t{0x435} : c == 0x439 ? char32_t{0x438} : c}, false, true);
  }
  const auto unspaced = [](std::u32string folded) { return Letter{std::move(folded), Kind::kUnspaced}; };
  if (c >= 0xAC00 && c <= 0xD7A3) {
    const char32_t s = c - 0xAC00, last = s % 28;
    std::u32string jamo{0x1100 + s / 588, 0x1161 + s % 588 / 28};
    if (last > 0) jamo += 0x11A7 + last;
    return unspaced(jamo);
  }
  if (c >= 0x3041 && c <= 0x30FC && c != 0x30FB) return unspaced({fold_kana(c)});
  if ((c >= 0x1100 && c <= 0x11FF) || (c >= 0x3400 && c <= 0x9FFF) || c == 0x3005) return unspaced({c});
  if (c < 0x80 || c == kBroken || (c >= 0x80 && c < 0xC0) || (c >= 0x2000 && c <= 0x303F) || c >= 0xFF00) return {};
  return spelled({c}, false, false);
}

}  // namespace

std::vector<Letter> letters_of(std::string_view name) {
  std::vector<Letter> out;
  for (std::size_t at = 0; at < name.size();) {
    const char32_t c = next_code_point(name, at);
    if (!is_combining(c)) out.push_back(letter_of(c));
  }
  return out;
}

std::u32string fold(std::string_view text) {
  std::u32string out;
  for (const Letter& letter : letters_of(text)) out += letter.folded;
  return out;
}

std::string to_utf8(const std::u32string& text) {
  std::string out;
  for (const char32_t c : text) {
    const unsigned more = c < 0x80 ? 0 : c < 0x800 ? 1 : c < 0x10000 ? 2 : 3;
    constexpr unsigned kMarks[]{0, 0xC0, 0xE0, 0xF0};
    out += static_cast<char>(kMarks[more] | c >> 6 * more);
    for (unsigned i = more; i-- > 0;) out += static_cast<char>(0x80 | (c >> 6 * i & 0x3F));
  }
  return out;
}

}  // namespace spherechain::baker
