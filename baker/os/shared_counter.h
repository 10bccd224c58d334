// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>

namespace spherechain::baker {

// A counter that this process shares with all processes that are forked while it exists.
class SharedCounter {
 public:
  SharedCounter();  // throws std::bad_alloc
  ~SharedCounter();
  SharedCounter(const SharedCounter&) = delete;
  SharedCounter& operator=(const SharedCounter&) = delete;

  std::size_t value() const { return *value_; }
  std::size_t take() { return (*value_)++; }  // returns the value before

 private:
  using Value = std::atomic<std::size_t>;
  static_assert(Value::is_always_lock_free);
  Value* value_;
};

}  // namespace spherechain::baker
