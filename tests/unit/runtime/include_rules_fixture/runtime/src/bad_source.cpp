// SPDX-License-Identifier: MIT
// Never compiled: include_rules.cmake must complain of Eigen and of mesh, not of the others.
#include <Eigen/Dense>
#include <vector>

#include "mesh/mesh.h"
#include "spherechain/asset.h"
