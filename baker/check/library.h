// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "baker/check/rules.h"

namespace spherechain::baker {

// A character and the recordings that are carried over to it; its own clips come with its file.
struct LibraryCharacter {
  std::string name;  // unique: the file's, as far as needed with its folders
  std::filesystem::path file;
  struct Motion {
    std::string name;
    std::filesystem::path file;
    std::string error = {};  // a folder that cannot be read stands for the recordings in it
  };
  std::vector<Motion> motions;
  CheckConfig config;
  std::filesystem::path relative;  // the file's path below the folder, or the manifest, that has it
  std::string error = {};          // a folder that cannot be read stands for the characters in it
};

struct Library {
  std::vector<LibraryCharacter> characters;
  std::vector<std::filesystem::path> folders;  // all files in them and below were looked at; as they are on disk
};

// The characters of `paths`: files, folders (all files in them and below that a character may be in), and manifests
// (*.json). `motion`, where it is not empty, is a recording or a folder of them for every character. Throws
// Error(kFile) where there is none, a path is not there, or a manifest is wrong.
Library read_library(const std::vector<std::string>& paths, const std::string& motion, const CheckConfig& config);

}  // namespace spherechain::baker
