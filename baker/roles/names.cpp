// SPDX-License-Identifier: GPL-3.0-or-later
#include "roles/names.h"

#include <fmt/format.h>

#include <cctype>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace spherechain::baker {
namespace {

using Lexicon = std::unordered_map<std::string_view, Word>;

// Words as rigs write them, parts joined and in lower case.
const Lexicon& lexicon() {
  static const Lexicon words{{"root", Word::kRoot},
                             {"armature", Word::kRoot},
                             {"reference", Word::kRoot},
                             {"cog", Word::kRoot},
                             {"hips", Word::kPelvis},
                             {"pelvis", Word::kPelvis},
                             {"hip", Word::kHip},
                             {"spine", Word::kSpine},
                             {"torso", Word::kSpine},
                             {"abdomen", Word::kSpine},
                             {"ab", Word::kSpine},
                             {"waist", Word::kSpine},
                             {"back", Word::kSpine},
                             {"lowerback", Word::kSpine},
                             {"belly", Word::kSpine},
                             {"stomach", Word::kSpine},
                             {"body", Word::kSpine},
                             {"chest", Word::kChest},
                             {"upperchest", Word::kChest},
                             {"thorax", Word::kChest},
                             {"ribcage", Word::kChest},
                             {"ribs", Word::kChest},
                             {"neck", Word::kNeck},
                             {"head", Word::kHead},
                             {"skull", Word::kHead},

                             {"clavicle", Word::kClavicle},
                             {"collar", Word::kClavicle},
                             {"collarbone", Word::kClavicle},
                             {"scapula", Word::kClavicle},
                             {"shoulderblade", Word::kClavicle},
                             {"clav", Word::kClavicle},
                             {"shoulder", Word::kShoulder},
                             {"shldr", Word::kShoulder},
                             {"arm", Word::kArm},
                             {"wing", Word::kArm},
                             {"upperarm", Word::kUpperArm},
                             {"uparm", Word::kUpperArm},
                             {"armupper", Word::kUpperArm},
                             {"bicep", Word::kUpperArm},
                             {"biceps", Word::kUpperArm},
                             {"humerus", Word::kUpperArm},
                             {"forearm", Word::kForeArm},
                             {"lowerarm", Word::kForeArm},
                             {"lowarm", Word::kForeArm},
                             {"loarm", Word::kForeArm},
                             {"armlower", Word::kForeArm},
                             {"elbow", Word::kForeArm},
                             {"ulna", Word::kForeArm},
                             {"foretwist", Word::kForeArm},
                             {"hand", Word::kHand},
                             {"wrist", Word::kHand},
                             {"palm", Word::kHand},
                             {"finger", Word::kFinger},
                             {"fingers", Word::kFinger},
                             {"thumb", Word::kFinger},
                             {"index", Word::kFinger},
                             {"middle", Word::kFinger},
                             {"ring", Word::kFinger},
                             {"pinky", Word::kFinger},
                             {"pinkie", Word::kFinger},
                             {"little", Word::kFinger},
                             {"metacarpal", Word::kFinger},
                             {"carpal", Word::kFinger},
                             {"knuckle", Word::kFinger},

                             {"hipjoint", Word::kHip},
                             {"leg", Word::kLeg},
                             {"foreleg", Word::kLeg},
                             {"hindleg", Word::kLeg},
                             {"thigh", Word::kThigh},
                             {"upperleg", Word::kThigh},
                             {"upleg", Word::kThigh},
                             {"legupper", Word::kThigh},
                             {"femur", Word::kThigh},
                             {"shin", Word::kShin},
                             {"calf", Word::kShin},
                             {"knee", Word::kShin},
                             {"lowerleg", Word::kShin},
                             {"lowleg", Word::kShin},
                             {"loleg", Word::kShin},
                             {"leglower", Word::kShin},
                             {"tibia", Word::kShin},
                             {"foot", Word::kFoot},
                             {"ankle", Word::kFoot},
                             {"paw", Word::kFoot},
                             {"hoof", Word::kFoot},
                             {"toe", Word::kToe},
                             {"toes", Word::kToe},
                             {"toebase", Word::kToe},
                             {"ball", Word::kToe},
                             {"metatarsal", Word::kToe},
                             {"metatarsals", Word::kToe},

                             {"tail", Word::kTail},
                             {"eye", Word::kEye},
                             {"eyeball", Word::kEye},
                             {"jaw", Word::kJaw},
                             {"chin", Word::kJaw},
                             {"hair", Word::kHair},
                             {"ponytail", Word::kHair},
                             {"bangs", Word::kHair},
                             {"braid", Word::kHair},
                             {"face", Word::kHeadPart},
                             {"tongue", Word::kHeadPart},
                             {"teeth", Word::kHeadPart},
                             {"lip", Word::kHeadPart},
                             {"lips", Word::kHeadPart},
                             {"mouth", Word::kHeadPart},
                             {"nose", Word::kHeadPart},
                             {"ear", Word::kHeadPart},
                             {"brow", Word::kHeadPart},
                             {"eyebrow", Word::kHeadPart},
                             {"eyelid", Word::kHeadPart},
                             {"lid", Word::kHeadPart},
                             {"cheek", Word::kHeadPart},
                             {"forehead", Word::kHeadPart},
                             {"horn", Word::kHeadPart},
                             {"antenna", Word::kHeadPart},
                             {"mandible", Word::kHeadPart},

                             {"handslot", Word::kAttachment},
                             {"slot", Word::kAttachment},
                             {"socket", Word::kAttachment},
                             {"weapon", Word::kAttachment},
                             {"prop", Word::kAttachment},
                             {"attach", Word::kAttachment},
                             {"attachment", Word::kAttachment},
                             {"mount", Word::kAttachment},
                             {"grip", Word::kAttachment},
                             {"holder", Word::kAttachment},
                             {"camera", Word::kAttachment},
                             {"sec", Word::kCloth},
                             {"skirt", Word::kCloth},
                             {"coat", Word::kCloth},
                             {"cloth", Word::kCloth},
                             {"cape", Word::kCloth},
                             {"cloak", Word::kCloth},
                             {"sleeve", Word::kCloth},
                             {"hood", Word::kCloth},
                             {"breast", Word::kCloth},
                             {"boob", Word::kCloth},
                             {"bust", Word::kCloth},
                             {"pec", Word::kCloth},
                             {"ribbon", Word::kCloth},
                             {"belt", Word::kCloth},
                             {"pad", Word::kCloth},
                             {"armor", Word::kCloth},
                             {"armour", Word::kCloth},
                             {"plate", Word::kCloth},
                             {"ik", Word::kControl},
                             {"fk", Word::kControl},
                             {"ctrl", Word::kControl},
                             {"control", Word::kControl},
                             {"ctl", Word::kControl},
                             {"pole", Word::kControl},
                             {"target", Word::kControl},
                             {"mch", Word::kControl},
                             {"wgt", Word::kControl},
                             {"vis", Word::kControl},
                             {"tweak", Word::kControl},
                             {"footsteps", Word::kControl}};
  return words;
}

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

bool is_letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 128;
}
bool is_upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }
bool is_lower(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }

// Runs of letters in lower case: split at all else, before a capital after a small letter, and before the last of
// several capitals ("LHipJoint" -> l hip joint). What stands before a colon or a bar is a namespace.
std::vector<std::string> split(std::string_view name) {
  const std::size_t space = name.find_last_of(":|");
  if (space != std::string_view::npos && space + 1 < name.size()) name.remove_prefix(space + 1);
  std::vector<std::string> tokens;
  bool open = false;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    if (!is_letter(c)) {
      open = false;
      continue;
    }
    const bool hump =
        i > 0 && is_upper(c) &&
        (is_lower(name[i - 1]) || (is_upper(name[i - 1]) && i + 1 < name.size() && is_lower(name[i + 1])));
    if (!open || hump) tokens.emplace_back();
    open = true;
    tokens.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return tokens;
}

NamedSide side_of(std::string_view token) {
  if (token == "l" || token == "left" || token == "lf" || token == "lft") return NamedSide::kLeft;
  if (token == "r" || token == "right" || token == "rt" || token == "rgt") return NamedSide::kRight;
  return NamedSide::kNone;
}

Place place_of(std::string_view token) {
  if (token == "front" || token == "fore" || token == "foreleg") return Place::kFront;
  if (token == "hind" || token == "rear" || token == "back" || token == "hindleg") return Place::kHind;
  return Place::kNone;
}

// "leftarm", "rfoot", "armleft": the side is taken off where a word of a limb remains.
void split_off_side(std::string& token, NamedSide& side) {
  if (lexicon().contains(token)) return;
  const auto is_limb = [](std::string_view rest) {
    const auto found = lexicon().find(rest);
    return found != lexicon().end() && family_of(found->second) != Family::kNone;
  };
  for (const std::string_view word : {"left", "right", "l", "r"}) {
    const std::string_view all(token);
    std::string rest;
    if (all.starts_with(word) && is_limb(all.substr(word.size())))
      rest = all.substr(word.size());
    else if (word.size() > 1 && all.ends_with(word) && is_limb(all.substr(0, all.size() - word.size())))
      rest = all.substr(0, all.size() - word.size());
    if (rest.empty()) continue;
    side = side_of(word);
    token = rest;
    return;
  }
}

}  // namespace

Family family_of(Word word) {
  if (word >= Word::kClavicle && word <= Word::kFinger) return Family::kArm;
  if (word >= Word::kHipGirdle && word <= Word::kToe) return Family::kLeg;
  return Family::kNone;
}

Hint read_name(const std::string& name) {
  Hint hint;
  std::vector<std::string> words;
  std::string_view said;
  for (std::string& token : split(name)) {
    if (const NamedSide side = side_of(token); side != NamedSide::kNone) {
      hint.side = side;
      continue;
    }
    split_off_side(token, hint.side);
    if (token == "twist" || token == "roll" || token == "foretwist" || token == "twst") hint.twist = true;
    if (const Place place = place_of(token); place != Place::kNone) hint.place = place;
    words.push_back(std::move(token));
  }
  // Neighbours join first ("upper" "arm"), so that the longer word wins.
  for (std::size_t i = 0; i < words.size(); ++i) {
    for (std::size_t length = 2; length >= 1; --length) {
      if (i + length > words.size()) continue;
      const auto found = lexicon().find(length == 2 ? words[i] + words[i + 1] : words[i]);
      if (found == lexicon().end()) continue;
      if (precedence(found->second) >= precedence(hint.word)) {
        hint.word = found->second;
        said = found->first;
      }
      i += length - 1;
      break;
    }
  }
  if (hint.word == Word::kHip && hint.side == NamedSide::kNone) hint.word = Word::kPelvis;
  if (hint.word == Word::kPelvis && hint.side != NamedSide::kNone) hint.word = Word::kHipGirdle;
  if (family_of(hint.word) != Family::kLeg) hint.place = Place::kNone;
  if (hint.word != Word::kNone) hint.reason = fmt::format("its name says {}", said);
  return hint;
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
