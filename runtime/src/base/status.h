// SPDX-License-Identifier: MIT
#pragma once

#include "spherechain/types.h"

namespace spherechain {

constexpr Status done() { return {SC_OK, SC_FIELD_NONE}; }
constexpr Status refuse(sc_code code, sc_field field) { return {code, field}; }

}  // namespace spherechain
