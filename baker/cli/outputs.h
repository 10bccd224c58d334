// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace spherechain::baker {

// What a command asks of a file it is going to write, before the work that takes seconds. They throw Error(kFile).

// The folder is there and writable.
void check_folder(const std::string& file);

// Nothing is lost to a slip: a file that is there already is of the same kind (its bytes from `offset` on are `magic`,
// letters' case aside), or empty, or `force` is given.
void check_replaceable(const std::string& file, std::string_view magic, const std::string& kind, bool force,
                       std::size_t offset = 0);

}  // namespace spherechain::baker
