// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "baker/os/temporary.h"

namespace spherechain::baker {

// A file that is written piece by piece, and whole or untouched: `path` becomes it in finish(), and without that stays
// what it was. A path that is_written_directly gets each piece at once. Everything throws Error(kFile).
class AtomicFile {
 public:
  explicit AtomicFile(const std::filesystem::path& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view bytes);
  void finish();

 private:
  [[noreturn]] void fail(const char* doing) const;

  std::filesystem::path path_;
  std::optional<Temporary> temporary_;
  int direct_ = -1;
};

}  // namespace spherechain::baker
