// SPDX-License-Identifier: MIT
#include "baker/fit/fit.h"
#include "baker/segment/segment.h"
