// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "baker/import/fbx_tree.h"

namespace spherechain::baker {

// An array to write: as FbxArray has it.
struct FbxNewArray {
  char type = 0;
  bool is_packed = false;
  std::vector<std::string> items;
};
// A record to write. Its texts are as binary files have them: "R\0\1AnimCurveNode".
struct FbxNewRecord {
  using Value = std::variant<std::int32_t, std::int64_t, double, std::string, FbxNewArray>;
  std::string name;
  std::vector<Value> values;
  std::vector<FbxNewRecord> inside{};
};

// Changes of an FBX file. Every byte stays, except those of changed records, the offsets that follow from their sizes,
// and the padding before the end of a binary file, which aligns it to 16 bytes.
class FbxChanges {
 public:
  // The tree must be whole and outlive this.
  explicit FbxChanges(const FbxTree& tree) : tree_(tree) {}

  // Replaces a record's array.
  void set_array(const FbxRecord& record, FbxNewArray array);
  // Replaces a record's one value.
  void set_whole(const FbxRecord& record, std::int32_t value);
  // Adds a record at the end of those inside a record of the top level. It must have room for some.
  void append(const FbxRecord& parent, FbxNewRecord record);

  // The whole file. Throws std::length_error if its offsets do not fit into 32 bits, where the file has such.
  std::string bytes() const;

 private:
  struct Change {
    std::size_t begin, end;
    std::variant<std::string, FbxNewRecord> by;
  };

  const FbxTree& tree_;
  std::vector<Change> changes_;
};

}  // namespace spherechain::baker
