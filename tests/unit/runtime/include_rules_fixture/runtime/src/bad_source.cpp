// SPDX-License-Identifier: MIT
// Never compiled: include_rules.cmake must complain of the first two and not of the others.
#include "mesh/mesh.h"
#  include <Eigen/Dense>
#include <vector>
#include "spherechain/asset.h"
