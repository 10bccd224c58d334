// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "baker/events/event.h"
#include "baker/events/poke_event.h"

// Results of a check before any rule. They depend only on the character, clip, settings and tool.
namespace spherechain::baker {

struct ClipResult {
  int frames = 0;   // its own
  int between = 0;  // poses between them that were looked at, too
  double fps = 30;
  bool loops = false;
  std::vector<Event> events;     // by where they begin
  std::vector<PokeEvent> pokes;  // the largest first
  std::string note;              // what is wrong with the recording and does not keep it from being read
  std::string unseen;            // text of unseen_text()
  bool continuous = false;       // contacts between frames were checked, too
};

// The facts about an asset that the check of its character needs.
struct CharacterResult {
  std::vector<std::string> clips;  // its own; unique
  std::string grade;               // of the spheres' fit
  std::string fit;                 // the same as a sentence: fit_line's
  std::vector<std::string> notes;  // of its units, and its import's
  std::vector<std::string> parts;  // names of its body parts
  std::vector<std::string> limbs;  // of each part the part that its limb begins with; empty: it is of the trunk
};

// As the bytes of a file, and back; no result where the bytes are not whole.
std::string to_bytes(const ClipResult& result);
std::string to_bytes(const CharacterResult& result);
std::optional<ClipResult> read_clip_result(const std::string& bytes);
std::optional<CharacterResult> read_character_result(const std::string& bytes);

}  // namespace spherechain::baker
