// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace spherechain::baker {

// A hash of a file's bytes and those of the files that it names. Throws Error(kFile) where the file cannot be read.
std::string hash_of_input(const std::filesystem::path& file);

// A key stands for what a file held before it was read: throws Interrupted where it has another hash now.
void check_unchanged(const std::filesystem::path& file, const std::string& hash);

}  // namespace spherechain::baker
