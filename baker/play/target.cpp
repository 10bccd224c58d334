// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/play/target.h"

#include <cstdlib>

#include "baker/mesh/error.h"
#include "runtime/src/simd/simd.h"

namespace spherechain::baker {

Target choose_target(const std::string& backend) {
  if (backend == "scalar") return SC_TARGET_SCALAR;
  const char* wanted = std::getenv("SPHERECHAIN_TARGET");
  Target target = SC_TARGET_BEST;
  if (wanted != nullptr && *wanted != '\0' && !find_target(wanted, target)) {
    throw Error(ExitCode::kUsage, std::string("SPHERECHAIN_TARGET: '") + wanted +
                                      "' is no target of this machine (it has " + supported_targets_text() + ")");
  }
  return target == SC_TARGET_BEST ? supported_targets()[0] : target;
}

const char* backend_name(Target target) { return target == SC_TARGET_SCALAR ? "scalar" : "simd"; }

std::string backend_text(Target target) {
  return target == SC_TARGET_SCALAR ? "scalar" : std::string("simd (") + sc_target_name(target) + ")";
}

std::string supported_targets_text() {
  std::string text;
  for (const Target target : supported_targets())
    text += (text.empty() ? "" : ", ") + std::string(sc_target_name(target));
  return text;
}

}  // namespace spherechain::baker
