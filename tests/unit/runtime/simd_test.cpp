// SPDX-License-Identifier: MIT
#include "runtime/src/simd/simd.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <string>

namespace spherechain::test {

TEST_CASE("the targets of this machine are listed best first, each once, scalar last") {
  const Span<const Target> targets = supported_targets();
  REQUIRE(targets.size > 0);
  CHECK(targets[targets.size - 1] == SC_TARGET_SCALAR);
  CHECK(std::count(targets.begin(), targets.end(), SC_TARGET_BEST) == 0);
  CHECK(std::set<Target>(targets.begin(), targets.end()).size() == targets.size);
  std::size_t count = 0;
  CHECK(sc_supported_targets(&count) == targets.data);
  CHECK(count == targets.size);
  CHECK(lanes_of(SC_TARGET_BEST) == lanes_of(targets[0]));
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
  check(SC_TARGET_SCALAR, 1);
  check(SC_TARGET_SSE2, 4);
  check(SC_TARGET_SSSE3, 4);
  check(SC_TARGET_AVX2, 8);
  check(SC_TARGET_AVX512, 16);
  check(SC_TARGET_NEON, 4);
  check(SC_TARGET_WASM, 4);
  CHECK(lanes_of(static_cast<Target>(8)) == 0);
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
    if (target != SC_TARGET_SSE2) listed += std::string(sc_target_name(target)) + " ";
  }
  CHECK(listed == expected + "scalar ");
}
#endif

TEST_CASE("a target is found by its name, and only by one this machine has") {
  for (const Target target : supported_targets()) {
    Target found = SC_TARGET_BEST;
    CHECK(find_target(sc_target_name(target), found));
    CHECK(found == target);
  }
  Target found = SC_TARGET_SCALAR;
  CHECK(find_target("best", found));
  CHECK(found == SC_TARGET_BEST);
  for (const char* name : {"", "AVX2", "avx", "avx2 ", "unknown target", "scala"}) {
    found = SC_TARGET_NEON;
    CHECK(!find_target(name, found));
    CHECK(found == SC_TARGET_NEON);
  }
}

TEST_CASE("every target has a name of its own") {
  std::set<std::string> names;
  for (int i = 0; i <= 7; ++i) {
    CHECK(names.insert(sc_target_name(static_cast<Target>(i))).second);
  }
  CHECK(names.count("unknown target") == 0);
  CHECK(std::string(sc_target_name(static_cast<Target>(8))) == "unknown target");
}

}  // namespace spherechain::test
