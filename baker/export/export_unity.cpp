// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/export/for_engines.h"
#include "baker/export/formats.h"
#include "baker/export/scripts.h"

// The JSON is that of capsules.json, in its right-handed axes: the script mirrors it as Unity's importers do.
namespace spherechain::baker {

Export export_unity(const Colliders& given) {
  std::vector<std::string> notes;
  Colliders colliders = given;
  use_balls(colliders);
  use_capsules_for_ellipsoids(colliders, notes);
  keep_bodies_on_bones(colliders, notes);
  Export out = export_json(colliders);
  out.files.push_back({"SpherechainColliders.cs", kUnityScript});
  Colliders simpler = colliders;
  use_capsules_for_cones(simpler, notes);  // as the script does, for the note
  out.notes = notes;
  return out;
}

}  // namespace spherechain::baker
