// SPDX-License-Identifier: MIT
// fuzz_jobs [--seed N] [--cases N] [--seconds N]
// Calls every function of the runtime with assets and arguments drawn at random: sound ones, whose results are checked,
// and such as no caller should pass, which must give their status and field and write nothing.
// Case i is drawn from seed N + i alone: --seed (N + i) --cases 1 makes it again.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "fuzz_case.h"

namespace {

using namespace spherechain::test;

struct Kind {
  const char* name;
  void (*fuzz)(Case& c);
};
constexpr Kind kKinds[] = {
    {"open", fuzz_open},         {"accessors", fuzz_accessors}, {"filter", fuzz_filter},
    {"prepare", fuzz_prepare},   {"binding", fuzz_binding},     {"model", fuzz_model},
    {"refit", fuzz_refit},       {"detect", fuzz_detect},       {"crowd", fuzz_crowd},
    {"contacts", fuzz_contacts}, {"bodies", fuzz_bodies},       {"penetrations", fuzz_penetrations},
    {"steps", fuzz_steps},       {"response", fuzz_response}};
constexpr std::size_t kKindCount = sizeof kKinds / sizeof kKinds[0];

bool read_number(int argc, char** argv, int& i, const char* name, std::uint64_t& number) {
  if (std::strcmp(argv[i], name) != 0 || i + 1 >= argc) {
    return false;
  }
  char* end = nullptr;
  number = std::strtoull(argv[++i], &end, 10);
  return *end == '\0';
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t seed = 0, cases = 24000, seconds = 0;
  for (int i = 1; i < argc; ++i) {
    if (!read_number(argc, argv, i, "--seed", seed) && !read_number(argc, argv, i, "--cases", cases) &&
        !read_number(argc, argv, i, "--seconds", seconds)) {
      std::fputs("usage: fuzz_jobs [--seed N] [--cases N] [--seconds N], which goes on for so long\n", stderr);
      return 2;
    }
  }
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::seconds(seconds);
  Arena arena;
  Tally tallies[kKindCount];
  std::uint64_t made = 0;
  for (; seconds > 0 ? Clock::now() < end : made < cases; ++made) {
    const std::size_t kind = (seed + made) % kKindCount;
    Case c(seed + made, arena);
    kKinds[kind].fuzz(c);
    if (c.wrong != nullptr) {
      std::fprintf(stderr, "fuzz_jobs: %s: %s; again: fuzz_jobs --seed %llu --cases 1\n", kKinds[kind].name, c.wrong,
                   static_cast<unsigned long long>(seed + made));
      return 1;
    }
    tallies[kind].ran += c.tally.ran;
    tallies[kind].overflowed += c.tally.overflowed;
    tallies[kind].refused += c.tally.refused;
  }
  bool checked = true;
  for (std::size_t i = 0; i < kKindCount; ++i) {
    std::printf("%-16s %8zu ran, %7zu overflowed, %8zu refused\n", kKinds[i].name, tallies[i].ran,
                tallies[i].overflowed, tallies[i].refused);
    checked = checked && tallies[i].ran > 0 && tallies[i].refused > 0;
  }
  std::printf("%llu cases from seed %llu on, %zu assets, targets:", static_cast<unsigned long long>(made),
              static_cast<unsigned long long>(seed), asset_count());
  std::size_t target_count = 0;
  const sc_target* const targets = sc_supported_targets(&target_count);
  for (std::size_t i = 0; i < target_count; ++i) {
    std::printf(" %s", sc_target_name(targets[i]));
  }
  std::puts("");
  if (!checked && made >= 1000) {
    std::fputs("fuzz_jobs: something never ran or was never refused, so nothing was checked\n", stderr);
    return 1;
  }
  return 0;
}
