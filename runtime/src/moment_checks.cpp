// SPDX-License-Identifier: MIT
#include "moment_checks.h"

#include "sphere_chains_generated.h"

namespace spherechain {

bool moment_values_are_valid(const schema::Asset& root, Message& message) {
  const schema::Moments* moments = root.bone_refit() == nullptr ? nullptr : root.bone_refit()->moments();
  if (moments == nullptr) {
    return root.refit() != schema::Refit::moments || message.wrong("bone_refit.moments: missing, but refit is moments");
  }
  return moments->origin() != nullptr || message.wrong("bone_refit.moments.origin: missing");
}

}  // namespace spherechain
