// SPDX-License-Identifier: MIT
#include "fit/fit.h"
#include "segment/segment.h"
