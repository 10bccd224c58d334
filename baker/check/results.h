// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "baker/mesh/mesh.h"
#include "baker/play/skin_player.h"

// Results of a check before any rule. They depend only on the character, clip, settings and tool.
namespace spherechain::baker {

struct Event {
  std::array<std::string, 2> parts;
  PenetrationClass kind = SC_CLASS_REST;   // of the deepest frame, like all members below
  double from = 0, to = 0, deepest = 0;    // frames, with a fraction between two; from > to: over the seam of a loop
  int first_place = 0, place = 0;          // of `from` and `deepest` among the frames that were looked at
  double depth_mm = 0, depth_percent = 0;  // of the character's height
  double volume_ml = -1;                   // -1: not known
  Vec3 direction = Vec3::Zero();           // moving part 1 by `depth_mm` along it frees it from part 0
  Vec3 point = Vec3::Zero();               // the deepest of part 1; the pose's space, source units
  std::optional<Vec3> eye;                 // of a fault: from the point to an eye that sees it; unit length
  std::vector<float> depths_mm;            // of a fault: in each frame of it; 0 where it is none
  int picture = 0;                         // of the clip's pictures the one that shows it; 0: none does
};

struct ClipResult {
  int frames = 0;   // its own
  int between = 0;  // poses between them that were looked at, too
  double fps = 30;
  bool loops = false;
  std::vector<Event> events;  // by where they begin
  std::string note;           // what is wrong with the recording and does not keep it from being read
  std::string unseen;         // text of unseen_text()
  bool continuous = false;    // contacts between frames were checked, too
};

// The frequency and depth with which a triangle of the skin takes part in a fault.
struct HeatSpot {
  std::uint32_t event;     // of the clip's
  std::uint32_t triangle;  // the source's number
  std::uint32_t frames;
  float depth_mm;  // of the deepest
};

// The facts about an asset that the check of its character needs.
struct CharacterResult {
  std::vector<std::string> clips;  // its own; unique
  std::string grade;               // of the spheres' fit
  std::string fit;                 // the same as a sentence: fit_line's
  std::vector<std::string> notes;  // of its units, and its import's
  std::vector<std::string> parts;  // names of its body parts
};

// As the bytes of a file, and back; no result where the bytes are not whole.
std::string to_bytes(const ClipResult& result);
std::string to_bytes(const CharacterResult& result);
std::optional<ClipResult> read_clip_result(const std::string& bytes);
std::optional<CharacterResult> read_character_result(const std::string& bytes);

}  // namespace spherechain::baker
