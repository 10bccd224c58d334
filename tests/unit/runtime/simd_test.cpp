// SPDX-License-Identifier: MIT
#include "spherechain/simd.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <string>

namespace spherechain::test {

TEST_CASE("the targets of this machine are listed best first, each once, scalar last") {
  const Span<const Target> targets = supported_targets();
  REQUIRE(targets.size > 0);
  CHECK(targets[targets.size - 1] == Target::kScalar);
  CHECK(std::count(targets.begin(), targets.end(), Target::kBest) == 0);
  CHECK(std::set<Target>(targets.begin(), targets.end()).size() == targets.size);
  CHECK(best_target() == targets[0]);
  CHECK(lanes_of(Target::kBest) == lanes_of(best_target()));
  for (std::size_t i = 1; i < targets.size; ++i) {
    CHECK(lanes_of(targets[i]) <= lanes_of(targets[i - 1]));
  }
}

TEST_CASE("a register of a target holds the floats its name says") {
  const auto check = [](Target target, std::size_t lanes) {
    const Span<const Target> targets = supported_targets();
    const bool supported = std::count(targets.begin(), targets.end(), target) > 0;
    CHECK(lanes_of(target) == (supported ? lanes : 0));
  };
  check(Target::kScalar, 1);
  check(Target::kSse2, 4);
  check(Target::kSsse3, 4);
  check(Target::kAvx2, 8);
  check(Target::kAvx512, 16);
  check(Target::kNeon, 4);
  CHECK(lanes_of(static_cast<Target>(7)) == 0);
  CHECK(lanes_of(static_cast<Target>(255)) == 0);
}

#if defined(__x86_64__)
TEST_CASE("on x86 this machine's list is the one its compiler's own test of the processor gives") {
  std::string expected;
  if (__builtin_cpu_supports("avx512bw")) expected += "avx512 ";
  if (__builtin_cpu_supports("avx2")) expected += "avx2 ";
  if (__builtin_cpu_supports("ssse3")) expected += "ssse3 ";
  std::string listed;
  for (const Target target : supported_targets()) {
    if (target != Target::kSse2) listed += std::string(to_string(target)) + " ";
  }
  CHECK(listed == expected + "scalar ");
}
#endif

TEST_CASE("a target is found by its name, and only by one this machine has") {
  for (const Target target : supported_targets()) {
    Target found = Target::kBest;
    CHECK(find_target(to_string(target), found) == Status::kOk);
    CHECK(found == target);
  }
  Target found = Target::kScalar;
  CHECK(find_target("best", found) == Status::kOk);
  CHECK(found == Target::kBest);
  for (const char* name : {"", "AVX2", "avx", "avx2 ", "unknown target", "scala"}) {
    found = Target::kNeon;
    CHECK(find_target(name, found) == Status::kUnsupportedTarget);
    CHECK(found == Target::kNeon);
  }
  CHECK(find_target(nullptr, found) == Status::kNullArgument);
}

TEST_CASE("every target has a name of its own") {
  std::set<std::string> names;
  for (int i = 0; i <= 6; ++i) {
    CHECK(names.insert(to_string(static_cast<Target>(i))).second);
  }
  CHECK(names.count("unknown target") == 0);
  CHECK(std::string(to_string(static_cast<Target>(7))) == "unknown target");
}

}  // namespace spherechain::test
