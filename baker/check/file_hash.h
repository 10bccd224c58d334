// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "baker/mesh/error.h"

namespace spherechain::baker {

// A hash of a file's bytes and those of the files that it names. Throws Error(kFile) where the file cannot be read.
std::string hash_of_input(const std::filesystem::path& file);

// Checks that a file still has the contents that its key was made of. Throws Interrupted if its hash has changed.
void check_unchanged(const std::filesystem::path& file, const std::string& hash);

// Runs `work`, which reads the file. Throws Interrupted if the file changed meanwhile, whatever `work` did.
template <typename Work>
void do_unchanged(const std::filesystem::path& file, const std::string& hash, const Work& work) {
  try {
    work();
  } catch (const Error&) {
    check_unchanged(file, hash);
    throw;
  }
  check_unchanged(file, hash);
}

}  // namespace spherechain::baker
