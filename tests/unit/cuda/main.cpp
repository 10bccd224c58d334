// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cstdio>

#include "crowd_runs.h"

int main(int argc, char** argv) {
  constexpr int kSkipped = 77;  // what ctest counts as skipped, not as passed
  const char* where = nullptr;
  if (!spherechain::test::can_run(where)) return kSkipped;
  std::printf("crowds %s\n", where);
  return doctest::Context(argc, argv).run();
}
