// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "mesh/error.h"

namespace spherechain::baker {

// A hash of a file's bytes and those of the files that it names. Throws Error(kFile) where the file cannot be read.
std::string hash_of_input(const std::filesystem::path& file);

// A key stands for what a file held before it was read: throws Interrupted where it has another hash now.
void check_unchanged(const std::filesystem::path& file, const std::string& hash);

// Does `work`, which reads the file. If the file changed meanwhile, neither what it made nor its error stands.
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
