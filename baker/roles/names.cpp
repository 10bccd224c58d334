// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/roles/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "baker/roles/letters.h"
#include "baker/roles/words.h"

namespace spherechain::baker {
namespace {

// The more telling of two words in one name: a finger of the hand, an eye of the face, the slot of a hand.
int precedence(Word word) {
  switch (word) {
    case Word::kNone:
      return 0;
    case Word::kRoot:
      return 1;
    case Word::kSpine:
      return 2;  // "back", "body" stand beside others
    case Word::kChest:
    case Word::kHead:
    case Word::kNeck:
    case Word::kPelvis:
      return 3;
    case Word::kEye:
    case Word::kJaw:
    case Word::kHeadPart:
      return 6;
    case Word::kFinger:
    case Word::kToe:
      return 5;
    case Word::kAttachment:
    case Word::kCloth:
    case Word::kHair:
      return 7;
    case Word::kControl:
      return 8;
    default:
      return 4;
  }
}

using Tokens = std::vector<std::u32string>;

// The known words of a run of letters that are set without spaces.
void split_unspaced(const std::u32string& run, Tokens& tokens) {
  for (std::size_t at = 0; at < run.size();) {
    const std::size_t length = longest_word(run, at);
    if (length > 0) tokens.push_back(run.substr(at, length));
    at += std::max<std::size_t>(length, 1);
  }
}

// Runs of letters without case: split at all else, before a capital after a small letter, and before the last of
// several capitals ("LHipJoint" -> l hip joint). The part of a name before a colon or a bar is a namespace.
Tokens split(std::string_view name) {
  const std::size_t space = name.find_last_of(":|");
  if (space != std::string_view::npos && space + 1 < name.size()) name.remove_prefix(space + 1);
  const std::vector<Letter> letters = letters_of(name);
  Tokens tokens;
  std::u32string run;  // of a script without spaces
  Letter before;
  for (std::size_t i = 0; i < letters.size(); ++i) {
    const Letter& letter = letters[i];
    if (letter.kind == Letter::Kind::kUnspaced) {
      run += letter.folded;
    } else {
      split_unspaced(run, tokens);
      run.clear();
    }
    if (letter.kind == Letter::Kind::kSpelled) {
      const bool hump = letter.is_upper &&
                        (before.is_lower || (before.is_upper && i + 1 < letters.size() && letters[i + 1].is_lower));
      if (before.kind != Letter::Kind::kSpelled || hump) tokens.emplace_back();
      tokens.back() += letter.folded;
    }
    before = letter;
  }
  split_unspaced(run, tokens);
  return tokens;
}

// "leftarm", "rfoot", "armleft": the side is taken off where a word of a limb remains, a long one from "leftear", too.
void split_off_side(std::u32string& token, NamedSide& side) {
  if (word_of(token, true) != Word::kNone) return;
  const auto take = [&](const std::u32string& word, bool ahead, NamedSide which, bool is_long) {
    if (token.size() <= word.size() || !(ahead ? token.starts_with(word) : token.ends_with(word))) return false;
    const std::u32string rest = token.substr(ahead ? word.size() : 0, token.size() - word.size());
    if (family_of(word_of(rest, true)) == Family::kNone && (!is_long || thing_of(rest).empty())) return false;
    side = which;
    token = rest;
    return true;
  };
  for (const std::u32string& word : glued_sides()) {
    if (take(word, true, side_of(word), true) || take(word, false, side_of(word), true)) return;
  }
  for (const auto& [word, which] : {std::pair{U"l", NamedSide::kLeft},
                                    {U"r", NamedSide::kRight},
                                    {U"zuo", NamedSide::kLeft},
                                    {U"you", NamedSide::kRight}}) {
    if (take(word, true, which, false)) return;
  }
}

// The names' tokens, each name as one text.
class AllNames {
 public:
  explicit AllNames(const std::vector<Tokens>& names) {
    for (const Tokens& tokens : names) keys_.insert(key_of(tokens));
  }

  // The side that an abbreviation tells, as there is another name that only has the other side's.
  NamedSide side_of_pair(Tokens tokens, std::size_t at) const {
    if (tokens.size() < 2) return NamedSide::kNone;
    const std::u32string own = tokens[at];
    for (const SidedPair& pair : pairs_with(own)) {
      tokens[at] = pair.other;
      if (keys_.contains(key_of(tokens)) && !(own.size() == 1 && is_lettered(tokens, at, own[0]))) return pair.side;
    }
    return NamedSide::kNone;
  }

 private:
  static std::u32string key_of(const Tokens& tokens) {
    std::u32string key;
    for (const std::u32string& token : tokens) key += token + U' ';
    return key;
  }

  // "hair_a", "hair_b" ... count, and tell no sides. `tokens` have the other letter of a pair.
  bool is_lettered(Tokens tokens, std::size_t at, char32_t own) const {
    const char32_t other = tokens[at][0];
    for (char32_t c = U'a'; c <= U'z'; ++c) {
      tokens[at] = std::u32string(1, c);
      if (c != own && c != other && keys_.contains(key_of(tokens))) return true;
    }
    return false;
  }

  std::unordered_set<std::u32string> keys_;
};

Hint read(const Tokens& tokens, const AllNames& all) {
  Hint hint;
  Tokens words;
  for (std::size_t t = 0; t < tokens.size(); ++t) {
    std::u32string token = tokens[t];
    NamedSide side = side_of(token);
    if (side == NamedSide::kNone) side = all.side_of_pair(tokens, t);
    if (side != NamedSide::kNone) {
      hint.side = side;
      continue;
    }
    split_off_side(token, hint.side);
    if (is_twist(token)) hint.twist = true;
    if (const Place place = place_of(token); place != Place::kNone) hint.place = place;
    words.push_back(std::move(token));
  }
  Section section = Section::kNone;
  bool of_foot = false;
  Word thing_word = Word::kNone;
  const bool has_side = hint.side != NamedSide::kNone;
  // Neighbours join first ("upper" "arm"), so that the longer word wins.
  for (std::size_t i = 0; i < words.size(); ++i) {
    constexpr std::size_t kJoinedMax = 3;
    for (std::size_t length = std::min(kJoinedMax, words.size() - i); length >= 1; --length) {
      std::u32string joined;
      for (std::size_t k = i; k < i + length; ++k) joined += words[k];
      const Word word = word_of(joined, has_side);
      if (word == Word::kNone) {
        if (length == 1 && section_of(joined) != Section::kNone) section = section_of(joined);
        continue;
      }
      of_foot = of_foot || word == Word::kFoot;
      if (const std::string_view thing = thing_of(joined);
          !thing.empty() && precedence(word) >= precedence(thing_word)) {
        hint.thing = thing;
        thing_word = word;
      }
      if (precedence(word) >= precedence(hint.word)) {
        hint.word = word;
        hint.reason = fmt::format("its name says {}", to_utf8(joined));
      }
      i += length - 1;
      break;
    }
  }
  const bool upper = section == Section::kUpper;
  if (section != Section::kNone && hint.word == Word::kArm) hint.word = upper ? Word::kUpperArm : Word::kForeArm;
  if (section != Section::kNone && hint.word == Word::kLeg) hint.word = upper ? Word::kThigh : Word::kShin;
  if (of_foot && hint.word == Word::kFinger) hint.word = Word::kToe;
  if (hint.word == Word::kHip && hint.side == NamedSide::kNone) hint.word = Word::kPelvis;
  if (hint.word == Word::kPelvis && hint.side != NamedSide::kNone) hint.word = Word::kHipGirdle;
  if (family_of(hint.word) != Family::kLeg) hint.place = Place::kNone;
  return hint;
}

}  // namespace

Family family_of(Word word) {
  if (word >= Word::kClavicle && word <= Word::kFinger) return Family::kArm;
  if (word >= Word::kHipGirdle && word <= Word::kToe) return Family::kLeg;
  return Family::kNone;
}

bool is_of_body(Word word) {
  return word != Word::kNone && word != Word::kRoot && word != Word::kAttachment && word != Word::kCloth &&
         word != Word::kControl;
}

std::vector<Hint> read_names(const std::vector<std::string>& names) {
  std::vector<Tokens> tokens;
  for (const std::string& name : names) tokens.push_back(split(name));
  const AllNames all(tokens);
  std::vector<Hint> hints;
  for (const Tokens& name : tokens) hints.push_back(read(name, all));
  return hints;
}

Hint hint_of_role(const std::string& role) {
  static const std::unordered_map<std::string_view, Word> sided{
      {"clavicle", Word::kClavicle}, {"shoulder", Word::kUpperArm}, {"elbow", Word::kForeArm},
      {"wrist", Word::kHand},        {"finger", Word::kFinger},     {"hip", Word::kThigh},
      {"knee", Word::kShin},         {"ankle", Word::kFoot},        {"toe", Word::kToe}};
  static const std::unordered_map<std::string_view, Word> plain{{"root", Word::kRoot},
                                                                {"pelvis", Word::kPelvis},
                                                                {"spine", Word::kSpine},
                                                                {"chest", Word::kChest},
                                                                {"neck", Word::kNeck},
                                                                {"head", Word::kHead},
                                                                {"tail", Word::kTail},
                                                                {"eye", Word::kEye},
                                                                {"jaw", Word::kJaw},
                                                                {"hair", Word::kHair},
                                                                {"head_part", Word::kHeadPart},
                                                                {"other", Word::kCloth},
                                                                {"control", Word::kControl},
                                                                {"attachment", Word::kAttachment}};
  Hint hint;
  std::string_view word = role;
  for (const auto& [prefix, side] : {std::pair{"left_", NamedSide::kLeft}, std::pair{"right_", NamedSide::kRight}}) {
    if (!word.starts_with(prefix)) continue;
    word.remove_prefix(std::string_view(prefix).size());
    hint.side = side;
  }
  const auto& words = hint.side == NamedSide::kNone ? plain : sided;
  if (const auto found = words.find(word); found != words.end()) {
    hint.word = found->second;
    hint.given = true;
    hint.reason = "the role file";
  }
  return hint;
}

}  // namespace spherechain::baker
