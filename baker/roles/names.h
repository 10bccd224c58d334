// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace spherechain::baker {

enum class NamedSide { kNone, kLeft, kRight };

// The part of the body that a name speaks of. Some words mean different joints in different rigs; the chain of joints
// decides: shoulder (clavicle or upper arm), arm (upper or fore arm), hip (pelvis or thigh), leg (thigh or shin).
enum class Word {
  kNone,
  kRoot,
  kPelvis,
  kSpine,
  kChest,
  kNeck,
  kHead,
  kClavicle,
  kShoulder,
  kArm,
  kUpperArm,
  kForeArm,
  kHand,
  kFinger,
  kHipGirdle,
  kHip,
  kLeg,
  kThigh,
  kShin,
  kFoot,
  kToe,
  kTail,
  kEye,
  kJaw,
  kHair,
  kHeadPart,
  kAttachment,
  kCloth,
  kControl,
};

enum class Place { kNone, kFront, kHind };

struct Hint {
  Word word = Word::kNone;
  NamedSide side = NamedSide::kNone;
  Place place = Place::kNone;
  bool twist = false;
  bool given = false;      // by a role file
  std::string_view thing;  // what is no limb and no trunk, by its everyday name: "ear", "sword" (words.h)
  std::string reason;
};

// The hint that each of a rig's names gives. Some names tell sides only beside others: "bras_g" and "bras_d".
std::vector<Hint> read_names(const std::vector<std::string>& names);

// The hint for a role of a role file. Its word is kNone and its reason empty where there is no such role.
Hint hint_of_role(const std::string& role);

// Whether a word means a part of the body, and no thing that is put on or taken into a hand.
bool is_of_body(Word word);

enum class Family { kNone, kArm, kLeg };
Family family_of(Word word);

}  // namespace spherechain::baker
