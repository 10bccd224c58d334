// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "baker/import/import.h"
#include "baker/motion/motion.h"

namespace spherechain::baker {

// The meshes of a pose sequence: all in a folder, by name, or those in a text file, one a line, relative to that file.
// Throws Error(kFile) where there are none.
std::vector<std::filesystem::path> sequence_files(const std::filesystem::path& folder_or_list);

// True if a path can be a pose sequence: a folder or a .txt file.
bool is_sequence(const std::filesystem::path& path);

// A motion given as whole meshes. All must have the rest mesh's vertices and triangles in the same order; Error(kFile)
// names the first that has not.
class SequenceMotion : public Motion {
 public:
  enum class Path {
    kFrames,  // the meshes are frames; straight lines between them
    kBezier   // the meshes are poses after rest; a quadratic Bezier curve goes through three of them at a time
  };
  SequenceMotion(const Character& character, const std::vector<std::filesystem::path>& files, Path path);

  Deformation at(double t) const override;
  int frame_count() const override { return path_ == Path::kFrames ? static_cast<int>(keys_.size()) : 0; }

 private:
  Path path_;
  std::vector<std::vector<Vec3>> keys_;
};

}  // namespace spherechain::baker
