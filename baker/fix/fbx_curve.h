// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "baker/import/fbx_changes.h"

namespace spherechain::baker {

inline constexpr double kFbxTicks = 46186158000;  // a second

// True if double precision holds it.
constexpr bool is_fbx_time(std::int64_t tick) {
  constexpr std::int64_t kMax = std::int64_t{1} << 53;
  return tick > -kMax && tick < kMax;
}

// A curve of an FBX file: the values of one axis over time. Keys that nobody sets stay as the file has them.
class FbxCurve {
 public:
  // One without keys, for a file of this form.
  explicit FbxCurve(const FbxTree& tree);
  // Throws Error(kFile) that begins with `where` if its arrays do not fit each other, or its times do not ascend.
  FbxCurve(const FbxTree& tree, const FbxRecord& record, const std::string& where);

  bool is_empty() const { return keys_.empty(); }
  bool has(std::int64_t tick) const { return keys_.contains(tick); }
  std::vector<std::int64_t> ticks() const;
  // The nearest keys before and after a time.
  std::optional<std::int64_t> before(std::int64_t tick) const;
  std::optional<std::int64_t> after(std::int64_t tick) const;
  // The value at a time. All curves are read as lines between keys, as assimp does. The curve must have a key.
  double at(std::int64_t tick) const;

  // Sets the value of a key, or adds one. From there to the next key the curve is a line.
  void set(std::int64_t tick, double value);
  // The curve is a line from this key, which it must have, to the next.
  void make_linear(std::int64_t tick);

  // Writes the keys into the record that they come from.
  void write(FbxChanges& changes) const;
  // The keys as a new record.
  FbxNewRecord record(std::int64_t id) const;

 private:
  // The arrays of a curve, as FBX orders them.
  enum Part : std::size_t { kTimes, kValues, kFlags, kData, kCounts, kParts };
  struct Key {
    double number;
    std::string value, flags;
    std::array<std::string, 4> data;  // tangents and their weights
  };
  std::array<FbxNewArray, kParts> arrays() const;

  std::array<const FbxRecord*, kParts> records_{};
  std::array<FbxNewArray, kParts> forms_;  // as the file has them: their items are in keys_, too
  std::map<std::int64_t, Key> keys_;
};

}  // namespace spherechain::baker
