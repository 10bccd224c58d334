// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "baker/os/atomic_file.h"

namespace spherechain::baker {

// Writes tables as numpy's .npz, an archive without compression. The first table is `writer`, the mark of this tool.
// The file is there after finish(). Everything throws Error(kFile), also where a table has more than kTableMax bytes.
class NpzFile {
 public:
  static constexpr std::size_t kTableMax = std::size_t{1} << 30;

  explicit NpzFile(const std::filesystem::path& path);

  // The last index of a shape runs fastest.
  void add(const std::string& name, const std::vector<float>& values, const std::vector<std::size_t>& shape);
  void add(const std::string& name, const std::vector<double>& values);
  void add(const std::string& name, const std::vector<std::int32_t>& values);
  void add(const std::string& name, const std::vector<std::string>& texts);
  void add(const std::string& name, const std::string& text);  // a table without a shape
  void finish();

 private:
  void add_bytes(const std::string& name, const std::string& type, const std::string& shape, const void* data,
                 std::size_t size);

  std::filesystem::path path_;
  AtomicFile file_;
  std::string directory_;
  std::uint64_t at_ = 0;
  unsigned count_ = 0;
};

// True if these are the first bytes of a file that NpzFile wrote.
bool is_own_npz(const std::string& start);

}  // namespace spherechain::baker
