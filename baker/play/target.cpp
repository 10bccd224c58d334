// SPDX-License-Identifier: GPL-3.0-or-later
#include "play/target.h"

#include <cstdlib>

#include "mesh/error.h"

namespace spherechain::baker {

Target choose_target(const std::string& backend) {
  if (backend == "scalar") return Target::kScalar;
  const char* wanted = std::getenv("SPHERECHAIN_TARGET");
  Target target = Target::kBest;
  if (wanted != nullptr && *wanted != '\0' && find_target(wanted, target) != Status::kOk) {
    throw Error(ExitCode::kUsage, std::string("SPHERECHAIN_TARGET: '") + wanted +
                                      "' is no target of this machine (it has " + supported_targets_text() + ")");
  }
  return target == Target::kBest ? best_target() : target;
}

const char* backend_name(Target target) { return target == Target::kScalar ? "scalar" : "simd"; }

std::string backend_text(Target target) {
  return target == Target::kScalar ? "scalar" : std::string("simd (") + to_string(target) + ")";
}

std::string supported_targets_text() {
  std::string text;
  for (const Target target : supported_targets()) text += (text.empty() ? "" : ", ") + std::string(to_string(target));
  return text;
}

}  // namespace spherechain::baker
