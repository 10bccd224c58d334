// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/page/page_rig.h"

#include <nlohmann/json.hpp>

#include "baker/page/page_axes.h"
#include "baker/play/posable.h"
#include "baker/report/vec3_json.h"

namespace spherechain::baker {

using nlohmann::ordered_json;

ordered_json page_rig(const AnimatedAsset& animated) {
  const PosableRig rig = posable_rig(animated);
  if (rig.joints.empty()) return nullptr;
  ordered_json joints = ordered_json::array(), limbs = ordered_json::array(), morphs = ordered_json::array();
  for (const Joint& joint : rig.joints) {
    joints.push_back({{"name", joint.name}, {"parent", joint.parent}, {"at", to_json(joint.position)}});
  }
  for (const PosableLimb& limb : rig.limbs) {
    limbs.push_back({{"name", limb.end_name},
                     {"middle_name", limb.middle_name},
                     {"upper", limb.upper},
                     {"middle", limb.middle},
                     {"end", limb.end},
                     {"tip", to_json(limb.tip)},
                     {"stands", limb.stands}});
  }
  if (rig.rig == PoseRig::kOwn) {
    for (const Morph& morph : animated.character().rig.morphs) morphs.push_back(morph.name);
  }
  return {{"is_own", rig.rig == PoseRig::kOwn},
          {"axes", axes_json(animated.frame())},
          {"joints", joints},
          {"limbs", limbs},
          {"hips", rig.hips},
          {"neck", rig.neck},
          {"head", rig.head},
          {"head_at", to_json(rig.head_center)},
          {"morphs", morphs}};
}

}  // namespace spherechain::baker
