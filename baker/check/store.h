// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace spherechain::baker {

// A folder of results, each under a key that is the hash of all that it depends on. A file in it is whole or not there,
// whenever a process ends; processes that write the same one write the same bytes.
class Store {
 public:
  // Makes the folder. Throws Error(kFile) where that cannot be done.
  explicit Store(std::filesystem::path folder);

  const std::filesystem::path& folder() const { return folder_; }
  // `kind` is the file's extension, with its dot.
  std::filesystem::path path(const std::string& key, const char* kind) const;
  bool has(const std::string& key, const char* kind) const;
  std::optional<std::string> read(const std::string& key, const char* kind) const;
  // Throws Error(kFile).
  void write(const std::string& key, const char* kind, std::string_view bytes) const;

 private:
  std::filesystem::path folder_;
};

// The tool that computes: its version and a hash of its program. A tool of other code uses no result of this one.
const std::string& tool_identity();

}  // namespace spherechain::baker
