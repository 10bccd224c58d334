// SPDX-License-Identifier: MIT
// Never compiled: include_rules.cmake must complain of the first and not of the others.
#include <flatbuffers/flatbuffers.h>
#include <cstddef>
#include "spherechain/types.h"
