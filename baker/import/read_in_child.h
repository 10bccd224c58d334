// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace spherechain::baker {

// Reading ends with an error where it takes longer or needs more memory: a damaged file may keep an importer busy for
// ever. SPHERECHAIN_IMPORT_SECONDS and SPHERECHAIN_IMPORT_MEMORY (in MB) in the environment replace these.
inline constexpr int kImportSeconds = 60, kImportMemory = 4096;

// Runs `read` in a child process and returns its bytes, so that no file can crash, block or fill this process. `file`
// is what errors call it. An Error that `read` throws is thrown here. Throws Error(kFile) where it crashes or reaches a
// limit, Error(kUsage) where a limit in the environment is no number. A child that is killed from outside is started
// once more; if that is killed too, throws Interrupted. The sanitizers need memory of their own: under them there is
// no limit.
std::string read_in_child(const std::string& file, const std::function<std::string()>& read);

}  // namespace spherechain::baker
