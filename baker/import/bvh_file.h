// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// A number of a frame: how far a joint moves along, turns about or grows along an axis (0 x, 1 y, 2 z) of its parent.
struct BvhChannel {
  enum class Kind { kPosition, kRotation, kScale } kind;
  int axis;
};

struct BvhJoint {
  std::string name;  // may have spaces; need not be unique
  int parent = -1;   // comes before its children; -1: a root
  Vec3 offset = Vec3::Zero();
  std::vector<BvhChannel> channels;  // rotations, in degrees, apply from the last to the first
  std::size_t first_column = 0;      // of the frame's numbers, that of the first channel
};

// A recording in the BVH format. An end site is a joint without channels, called "EndSite_" and the name of its parent.
struct BvhFile {
  std::vector<BvhJoint> joints;
  std::size_t width = 0;            // numbers of a frame
  double frame_time = 0;            // seconds
  std::vector<double> numbers;      // frame by frame
  std::vector<std::size_t> places;  // where in the text each number begins, if that was asked for
  // Where the text says how many frames there are, and where it would if it does not.
  std::size_t count_begin = 0, count_end = 0;
  std::string note;  // what is wrong with the file and does not keep it from being read; or empty

  std::size_t frames() const { return numbers.size() / width; }
};

// True if a text is BVH, by its first word.
bool is_bvh(std::string_view text);

// Reads a whole BVH file in linear time. It takes keywords in any case, names with spaces, a byte order mark, several
// roots, channels in any order, comments (lines that begin with # or //), and rows of numbers that go over several
// lines. All frames are read that are there, whatever number the file names; `note` says if that differs. `file` is for
// messages. Throws Error(kFile) that names the line and what is expected there.
BvhFile parse_bvh(std::string_view text, const std::string& file, bool with_places = false);

}  // namespace spherechain::baker
