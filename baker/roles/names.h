// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace spherechain::baker {

enum class NamedSide { kNone, kLeft, kRight };

// What a name speaks of. Where rigs disagree about a word it stays open until the chain of joints is known: a shoulder
// is a clavicle or an upper arm, an arm an upper or a fore arm, a hip a pelvis or a thigh, a leg a thigh or a shin.
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
  bool given = false;  // by a role file
  std::string reason;
};

Hint read_name(const std::string& name);

// The hint that stands for a role of a role file; kNone with an empty reason where there is no such role.
Hint hint_of_role(const std::string& role);

enum class Family { kNone, kArm, kLeg };
Family family_of(Word word);

}  // namespace spherechain::baker
