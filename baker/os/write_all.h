// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace spherechain::baker {

// Writes all of `bytes` to a descriptor, also where a signal interrupts it. Returns false and sets errno on failure.
bool write_all(int file, std::string_view bytes);

}  // namespace spherechain::baker
