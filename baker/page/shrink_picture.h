// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace spherechain::baker {

// A picture as a data URL, of at most so many pixels a side: a JPEG, or a PNG where that is smaller or `keeps_alpha`.
// `bytes` may be PNG, JPEG, TGA, BMP, PSD or GIF. Empty where they are none of these, damaged, or too large. They are
// read in a child process: whatever is in them, this one goes on.
std::string shrink_picture(const std::string& bytes, int size_max, bool keeps_alpha);

}  // namespace spherechain::baker
