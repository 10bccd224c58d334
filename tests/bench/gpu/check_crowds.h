// SPDX-License-Identifier: MIT
// Crowds of every character and clip against the CPU, bit for bit.
#pragma once

#include <string>
#include <vector>

namespace spherechain::bench {

// Sorted names of what spherechain_gpu_data wrote there.
std::vector<std::string> characters_in(const std::string& folder);

// Both radii, from bones and from spheres, in launches of all poses of a character. Prints a line for each. Characters
// that are not refitted by moments are left out.
bool check_crowds(const std::vector<std::string>& names, const std::string& folder);

}  // namespace spherechain::bench
