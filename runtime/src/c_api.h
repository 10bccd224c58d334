// SPDX-License-Identifier: MIT
// From the C API's types to the C++ ones. Arrays are handed over as they are: both sides have one layout.
#pragma once

#include <cstddef>
#include <type_traits>

#include "spherechain/asset.h"
#include "spherechain/filter.h"
#include "spherechain/refit_bones.h"
#include "spherechain/spherechain.h"

struct sc_asset {
  spherechain::Asset view;
};

namespace spherechain {

template <typename Cpp, typename C>
constexpr bool kSameStruct = std::is_standard_layout_v<Cpp>&& std::is_trivially_copyable_v<Cpp> &&
                             sizeof(Cpp) == sizeof(C) && alignof(Cpp) == alignof(C);

inline sc_status to_c(Status status) { return static_cast<sc_status>(status); }

// The C++ enums are bytes: a number that is none must not become one by being cut.
template <typename Enum>
Enum to_enum(std::int32_t value) {
  constexpr std::int32_t kNone = 255;
  return static_cast<Enum>(value >= 0 && value < kNone ? value : kNone);
}

template <typename Cpp, typename C>
Span<Cpp> to_span(C* data, std::size_t size) {
  static_assert(std::is_same_v<std::remove_const_t<Cpp>, std::remove_const_t<C>> || kSameStruct<Cpp, C>);
  return {reinterpret_cast<Cpp*>(data), size};
}

inline BoneMatrices to_cpp(const sc_bone_matrices& bones) {
  return {bones.data, bones.count, to_enum<MatrixLayout>(bones.layout), bones.stride};
}

inline Filter to_cpp(const sc_filter& filter) {
  return {{filter.ignored, filter.ignored_words},
          {filter.disabled, filter.disabled_words},
          {filter.padding, filter.padding_count}};
}

// A job's Filter, where it has one.
class FilterView {
 public:
  explicit FilterView(const sc_filter* filter) : is_there_(filter != nullptr) {
    if (is_there_) {
      filter_ = to_cpp(*filter);
    }
  }
  const Filter* get() const { return is_there_ ? &filter_ : nullptr; }

 private:
  Filter filter_;
  bool is_there_;
};

// What each job is checked for before anything else of it is read.
template <typename Job>
sc_status check_job(const Job* job) {
  if (job == nullptr) {
    return SC_NULL_ARGUMENT;
  }
  if (job->struct_size != sizeof(Job)) {
    return SC_WRONG_ABI;
  }
  return job->asset == nullptr ? SC_NULL_ARGUMENT : SC_OK;
}

}  // namespace spherechain
