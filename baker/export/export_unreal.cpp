// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/export/for_engines.h"
#include "baker/export/formats.h"
#include "baker/export/scripts.h"

// The JSON is that of capsules.json, in metres and right-handed: the script turns it as Unreal's importers do.
namespace spherechain::baker {

Export export_unreal(const Colliders& given) {
  std::vector<std::string> notes;
  Colliders colliders = given;
  use_balls(colliders);
  use_capsules_for_ellipsoids(colliders, notes);
  keep_bodies_on_bones(colliders, notes);
  join_bodies_of_a_bone(colliders, notes);
  Export out = export_json(colliders);
  out.files.push_back({"spherechain_colliders.py", kUnrealScript});
  Colliders simpler = colliders;
  use_capsules_for_cones(simpler, notes);  // as the script does beside the cones, for the note
  notes.emplace_back("Unreal's Python cannot set which bodies are tested: the script lists the pairs to be ignored");
  out.notes = notes;
  return out;
}

}  // namespace spherechain::baker
