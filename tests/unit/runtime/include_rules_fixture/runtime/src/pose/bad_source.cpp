// SPDX-License-Identifier: MIT
// Never compiled: include_rules.cmake must complain of Eigen, mesh and a later room, not of the others.
#include <Eigen/Dense>
#include <vector>

#include "baker/mesh/mesh.h"
#include "runtime/src/base/span.h"
#include "runtime/src/depth/sweep.h"
#include "spherechain/asset.h"
