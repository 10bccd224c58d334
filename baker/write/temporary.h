// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <mutex>

namespace spherechain::baker {

// The name of a file that is written beside `target` and then renamed to it. It is deleted where that does not happen,
// by a signal that ends the program too: SIGHUP, SIGINT, SIGQUIT, SIGTERM. A process has one at a time; the next waits.
class Temporary {
 public:
  explicit Temporary(const std::filesystem::path& target);
  ~Temporary();
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  const std::filesystem::path& path() const { return path_; }
  // False, and errno, where the target cannot be replaced.
  bool rename_to_target();

 private:
  std::lock_guard<std::mutex> only_one_;
  std::filesystem::path target_, path_;
};

}  // namespace spherechain::baker
