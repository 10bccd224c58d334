// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "runtime/src/skin/skin_table.h"

namespace spherechain::baker {

// Triangles that other pieces of the skin hide at rest: a body below a suit, teeth, the lining of a coat. From their
// fronts every look ends at another piece. One of every eight triangles of a cluster that follow one another is looked
// from. The clusters are of one piece each.
std::vector<char> find_covered(const Surface& surface);

}  // namespace spherechain::baker
