// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace spherechain::baker {

// Files and folders that this tool makes for itself beside what it writes. Their process holds a lock (flock) on them,
// so that another one can tell those that are in use from those that kill -9 left.

// ".spherechain-" + 80 bits that nobody can guess + `ending`.
std::string own_name(const char* ending);

inline constexpr const char* kTemporaryEnding = ".tmp";  // a file
inline constexpr const char* kWorkEnding = ".work";      // a folder

// True if own_name() made a name.
bool is_own_name(const std::string& name);

// Takes the lock of what was opened under `path`. False where another process has it, or has deleted what was there.
// True, too, where the file system has no locks: there nothing is deleted either.
bool lock_own(int file, const std::filesystem::path& path);

// Deletes what ended processes of this user left in a folder. On network file systems, whose locks may end at the
// machine, only what is older than a day.
void sweep(const std::filesystem::path& folder);

}  // namespace spherechain::baker
