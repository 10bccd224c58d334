// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>

#include "runtime/src/base/span.h"
#include "spherechain/contacts.h"

namespace spherechain {

// The least entries of a sorted list that fit a buffer, and how many there were. Sorted only by finish().
template <typename T>
class LeastEntries {
 public:
  explicit LeastEntries(Span<T> out) : out_(out) {}

  void add(const T& entry) {
    if (count_ < out_.size) {
      out_[count_] = entry;
    } else if (out_.size > 0) {
      if (count_ == out_.size) {
        std::make_heap(out_.begin(), out_.end(), is_before);
      }
      if (is_before(entry, out_[0])) {
        std::pop_heap(out_.begin(), out_.end(), is_before);
        out_[out_.size - 1] = entry;
        std::push_heap(out_.begin(), out_.end(), is_before);
      }
    }
    ++count_;
  }
  void finish() { std::sort(out_.begin(), out_.begin() + std::min(count_, out_.size), is_before); }

  bool is_wanted() const { return out_.size > 0; }
  bool overflowed() const { return out_.size > 0 && count_ > out_.size; }
  std::size_t count() const { return count_; }

 private:
  static bool is_before(const T& l, const T& r) { return key_of(l) < key_of(r); }
  static Pair key_of(const Pair& pair) { return pair; }
  static Pair key_of(const TriangleContact& contact) { return {contact.triangle_a, contact.triangle_b}; }

  Span<T> out_;
  std::size_t count_ = 0;
};

}  // namespace spherechain
