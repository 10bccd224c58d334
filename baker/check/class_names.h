// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "spherechain/contacts.h"

namespace spherechain::baker {

// The class that has this name in JSON; rest where none has.
inline PenetrationClass class_of_name(const std::string& name) {
  for (const PenetrationClass kind :
       {SC_CLASS_SHELL, SC_CLASS_TOUCH, SC_CLASS_FOLD, SC_CLASS_DEEP_FOLD, SC_CLASS_PENETRATION}) {
    if (name == sc_penetration_class_name(kind)) return kind;
  }
  return SC_CLASS_REST;
}

}  // namespace spherechain::baker
