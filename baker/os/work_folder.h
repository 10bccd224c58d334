// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "baker/os/child_process.h"

namespace spherechain::baker {

// A folder in another one for what a run needs until it ends. No other run uses it. It is deleted with all in it when
// the run ends, whatever ends it: a process of its own waits for that, and also deletes the folders that were made for
// it, if they are empty. Throws Error(kFile) where it cannot be made.
class WorkFolder {
 public:
  explicit WorkFolder(const std::filesystem::path& in);
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  void start_deleter(const std::vector<std::filesystem::path>& made);
  void stop_deleter();

  std::filesystem::path path_;
  std::optional<ChildProcess> deleter_;
  int lock_ = -1;
};

}  // namespace spherechain::baker
