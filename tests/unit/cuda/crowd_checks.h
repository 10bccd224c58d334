// SPDX-License-Identifier: MIT
// A crowd's outputs against what the CPU's jobs gave.
#pragma once

#include "crowd_cases.h"

namespace spherechain::test {

// Counts, bits and list.
void check_pairs(const GroupInput& in, const GroupOutput& got, const Expected& wanted);

// In one launch, with a list of some room to spare; refitted spheres and pairs, bit for bit.
void run_and_check(std::vector<GroupInput> in, const std::vector<Expected>& wanted);
void run_and_check(GroupInput in, const Expected& wanted);

}  // namespace spherechain::test
