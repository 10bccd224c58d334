// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace spherechain::baker {

// A record of an FBX file, binary or text, such as `Model: 1001, "Model::Hips", "LimbNode" { ... }`.
struct FbxRecord {
  std::string_view name;
  std::size_t begin = 0, end = 0;  // its place in the file, with the records inside it
  std::string_view values;         // as the file has them
  std::size_t value_count = 0;     // in a binary file
  std::size_t inside_end = 0;      // where records inside it may be appended; 0: it has no room for any
  std::vector<FbxRecord> inside;

  // The first record of this name inside it; null if there is none.
  const FbxRecord* find(std::string_view wanted) const;
};

// A value of a record, as both forms of the file have it.
struct FbxValue {
  std::optional<double> number;
  std::optional<std::int64_t> whole;
  std::string_view text;  // of a name without its kind: "Hips"
};

// An array of numbers. Its items are the file's own bytes, or words of a text.
struct FbxArray {
  char type = 0;           // 'f', 'd', 'i', 'l' or 'b', as binary files have it; 't' in a text
  bool is_packed = false;  // by zlib
  std::vector<std::string_view> items;
  std::vector<char> unpacked;  // which the items of a packed array lead into

  FbxArray() = default;
  FbxArray(FbxArray&&) = default;
  FbxArray& operator=(FbxArray&&) = default;

  double number(std::size_t item) const;
  std::int64_t whole(std::size_t item) const { return whole(type, items[item]); }
  static std::int64_t whole(char type, std::string_view item);
};
// Items of this type from a number.
std::string fbx_item(char type, double number);
std::string fbx_item(char type, std::int64_t whole);

// The records of an FBX file of version 7. Views lead into `bytes`.
struct FbxTree {
  std::string_view bytes;
  bool is_binary = false, is_wide = false;  // wide: offsets of 64 bits, from version 7.5 on
  std::uint32_t version = 0;                // 7400 is 7.4; 0 if the file does not say
  bool is_whole = true;                     // a damaged record ends the list that it is in, and makes this false
  std::size_t end = 0;                      // of the last record; a binary file has a footer behind it
  std::vector<FbxRecord> records;

  const FbxRecord* find(std::string_view name) const;
  // Up to the first value that is an array or raw bytes.
  std::vector<FbxValue> values(const FbxRecord& record) const;
  // Empty where the record holds no array of numbers, or a damaged one.
  std::optional<FbxArray> array(const FbxRecord& record) const;
};

bool is_fbx(std::string_view bytes);
FbxTree parse_fbx(std::string_view bytes);

}  // namespace spherechain::baker
