// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <mutex>
#include <string_view>

namespace spherechain::baker {

// A new file beside `target`, which is renamed to it. It has a name that nobody can guess, and the mode, owner and
// group of the file that it replaces, as far as the system lets it. It is deleted where it is not renamed, by a signal
// that ends the program too: SIGHUP, SIGINT, SIGQUIT, SIGTERM. The next Temporary in its folder deletes it after a kill
// -9. A process has one at a time; the next waits.
class Temporary {
 public:
  explicit Temporary(const std::filesystem::path& target);
  ~Temporary();
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  bool is_open() const { return file_ >= 0; }  // else errno says why
  // Each returns false and sets errno if it fails.
  bool write(std::string_view bytes);
  bool flush_to_disk();
  bool rename_to_target();

 private:
  void open();

  std::lock_guard<std::mutex> only_one_;
  std::filesystem::path target_, path_;
  int file_ = -1;
};

}  // namespace spherechain::baker
