// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace spherechain::baker {

// A folder of results, each under a key that is the hash of all that it depends on. Each file begins with the hash of
// its key, its kind and its bytes: a file that was damaged, or belongs elsewhere, is as good as none. Processes that
// write the same file write the same bytes.
class Store {
 public:
  // Makes the folder. Throws Error(kFile) where that cannot be done.
  explicit Store(std::filesystem::path folder);

  const std::filesystem::path& folder() const { return folder_; }
  // `kind` is the file's extension, with its dot. No bytes where the file is not there, or not whole.
  std::optional<std::string> read(const std::string& key, const std::string& kind) const;
  // Reads a file that this run made or found. Throws Error(kFile) where somebody deleted it meanwhile.
  std::string take(const std::string& key, const std::string& kind) const;
  [[noreturn]] void fail_lost() const;
  bool has(const std::string& key, const std::string& kind) const { return read(key, kind).has_value(); }
  // Throws Error(kFile).
  void write(const std::string& key, const std::string& kind, std::string_view bytes) const;

 private:
  std::filesystem::path path(const std::string& key, const std::string& kind) const;

  std::filesystem::path folder_;
};

// Identifies the tool by its version and a hash of its program. Other builds do not use its results.
const std::string& tool_identity();

}  // namespace spherechain::baker
