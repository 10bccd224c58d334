// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/export/names.h"

#include <algorithm>

namespace spherechain::baker {

std::string with_allowed(std::string name, bool (*is_allowed)(char)) {
  std::replace_if(
      name.begin(), name.end(), [&](char c) { return !is_allowed(c); }, '_');
  return name;
}

std::vector<std::string> unique_names(const Colliders& colliders, bool (*is_allowed)(char),
                                      std::set<std::string> taken) {
  std::vector<std::string> out;
  for (const ColliderBody& body : colliders.bodies) {
    const std::string name = with_allowed(body.name, is_allowed);
    std::string unique = name;
    for (int number = 2; !taken.insert(unique).second; ++number) unique = name + "_" + std::to_string(number);
    out.push_back(unique);
  }
  return out;
}

}  // namespace spherechain::baker
