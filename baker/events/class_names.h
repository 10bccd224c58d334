// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "spherechain/contacts.h"

namespace spherechain::baker {

// The class with this name in JSON; SC_CLASS_REST for unknown names.
inline PenetrationClass class_of_name(const std::string& name) {
  for (const PenetrationClass kind :
       {SC_CLASS_SHELL, SC_CLASS_TOUCH, SC_CLASS_FOLD, SC_CLASS_DEEP_FOLD, SC_CLASS_PENETRATION, SC_CLASS_INSIDE}) {
    if (name == sc_penetration_class_name(kind)) return kind;
  }
  return SC_CLASS_REST;
}

}  // namespace spherechain::baker
