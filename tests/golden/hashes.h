// SPDX-License-Identifier: MIT
// Named hashes, and the table of them that is compared with a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "spherechain/contacts.h"

namespace spherechain::test {

// FNV-1a over words of 32 bits, low byte first, and how many entries there were.
class Hash {
 public:
  void add(std::uint32_t word);
  void add(float value);
  void add(const Vec3& v);
  void add(const Sphere& sphere);
  void add(const Pair& pair);
  void add(const PartContact& contact);
  void add(const Penetration& penetration);

  // A frame's array of fixed size.
  template <typename T>
  void add_array(const std::vector<T>& array) {
    for (const T& entry : array) add(entry);
    count_ += array.size();
  }
  // A frame's list and its end.
  template <typename T>
  void add_list(const std::vector<T>& list) {
    add_array(list);
    add(0xFFFFFFFFU);
  }

  std::string line(const std::string& name) const;

 private:
  std::uint64_t value_ = 14695981039346656037U;
  std::size_t count_ = 0;
};

class HashTable {
 public:
  // Every way to get a line must give the same. `how` names the way: a target, a number of threads.
  void add(const std::string& name, const Hash& hash, const std::string& how);
  // Prints what is wrong where `holds` is false.
  void expect(bool holds, const char* what, const std::string& how);

  const std::vector<std::string>& lines() const { return lines_; }
  // True if all ways agreed and all expectations held.
  bool agrees() const { return agrees_; }
  // True if the file has these lines and no others. Prints those that differ.
  bool is_that_of(const std::string& file) const;

 private:
  std::vector<std::string> lines_;
  bool agrees_ = true;
};

}  // namespace spherechain::test
