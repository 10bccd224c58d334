// SPDX-License-Identifier: MIT
#include "hashes.h"

#include <algorithm>
#include <cinttypes>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <fstream>

namespace spherechain::test {
namespace {

constexpr int kNameWidth = 28;

}  // namespace

void Hash::add(std::uint32_t word) {
  for (unsigned shift = 0; shift < 32; shift += 8) value_ = (value_ ^ (word >> shift & 0xFF)) * 1099511628211U;
}
void Hash::add(float value) {
  std::uint32_t word = 0;
  std::memcpy(&word, &value, sizeof word);
  add(word);
}
void Hash::add(const Vec3& v) { add(v.x), add(v.y), add(v.z); }
void Hash::add(const Sphere& sphere) { add(Vec3{sphere.x, sphere.y, sphere.z}), add(sphere.radius); }
void Hash::add(const Pair& pair) { add(pair.a), add(pair.b); }
void Hash::add(const PartContact& contact) {
  add(contact.part_a), add(contact.part_b), add(contact.triangle_pairs), add(contact.low), add(contact.high);
}

void Hash::add(const Penetration& p) {
  constexpr std::size_t kBytes = offsetof(Penetration, measures) + offsetof(Measures, reserved);
  static_assert(kBytes % sizeof(std::uint32_t) == 0, "words alone, without padding");
  std::uint32_t words[kBytes / sizeof(std::uint32_t)];
  std::memcpy(words, &p, kBytes);
  for (const std::uint32_t word : words) add(word);
}

std::string Hash::line(const std::string& name) const {
  char text[120];
  std::snprintf(text, sizeof text, "%-*s %8zu %016" PRIx64, kNameWidth, name.c_str(), count_, value_);
  return text;
}

void HashTable::add(const std::string& name, const Hash& hash, const std::string& how) {
  const std::string line = hash.line(name);
  const auto same_name = [&](const std::string& other) {
    return other.compare(0, kNameWidth + 1, line, 0, kNameWidth + 1) == 0;
  };
  const auto found = std::find_if(lines_.begin(), lines_.end(), same_name);
  if (found == lines_.end()) {
    lines_.push_back(line);
  } else if (*found != line) {
    std::fprintf(stderr, "golden: %s differs: %s, elsewhere %s\n", how.c_str(), line.c_str(), found->c_str());
    agrees_ = false;
  }
}

void HashTable::expect(bool holds, const char* what, const std::string& how) {
  if (!holds) std::fprintf(stderr, "golden: %s: %s\n", how.c_str(), what);
  agrees_ = agrees_ && holds;
}

bool HashTable::is_that_of(const std::string& path) const {
  std::ifstream file(path);
  std::vector<std::string> wanted;
  for (std::string line; std::getline(file, line);) wanted.push_back(line);
  for (std::size_t i = 0; i < std::max(wanted.size(), lines_.size()); ++i) {
    const std::string found = i < lines_.size() ? lines_[i] : "nothing";
    const std::string expected = i < wanted.size() ? wanted[i] : "nothing";
    if (found != expected) {
      std::fprintf(stderr, "golden: found    %s\n        expected %s\n", found.c_str(), expected.c_str());
    }
  }
  return wanted == lines_;
}

}  // namespace spherechain::test
