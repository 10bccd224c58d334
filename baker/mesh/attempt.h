// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace spherechain::baker {

// Why a strategy has no result.
struct Reason {
  enum class Cause : std::uint8_t {
    kFailed,        // it was tried
    kDoesNotApply,  // it was not tried: it is for other characters
    kSettings,      // the settings contradict the character: related strategies are not tried
  };

  std::string what;  // one clause for people, without the file's name
  Cause cause = Cause::kFailed;
};

// Return value of a strategy: a result, or the reason why there is none. A stage tries its strategies in order. The
// error that it throws when all have failed is for the user. (C++23 has std::expected for this.)
template <typename T>
class Attempt {
 public:
  Attempt(T result) : state_(std::move(result)) {}
  Attempt(Reason reason) : state_(std::move(reason)) {}

  explicit operator bool() const { return state_.index() == 0; }
  // The result. Throws std::bad_variant_access where there is none.
  T& operator*() { return std::get<0>(state_); }
  const T& operator*() const { return std::get<0>(state_); }
  T* operator->() { return &std::get<0>(state_); }
  const T* operator->() const { return &std::get<0>(state_); }
  // Throws std::bad_variant_access where there is a result.
  const Reason& reason() const { return std::get<1>(state_); }

 private:
  std::variant<T, Reason> state_;
};

// A strategy, and why it was not taken.
struct PassedOver {
  std::string strategy;
  Reason reason;
};

// Which of a stage's strategies was taken, for reports.
struct Choice {
  std::string strategy;
  std::vector<PassedOver> passed_over;  // in the order in which they were tried
};

}  // namespace spherechain::baker
