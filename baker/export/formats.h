// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/volumes/colliders.h"

// Colliders as the files that other programs read. Each writer is a function from colliders to texts; what it cannot
// say in its format it replaces, and says so in `notes`.
namespace spherechain::baker {

struct ExportFile {
  std::string ending;  // ".urdf": put in place of -o's ending; "importer.cs": a file beside -o. Empty: -o itself
  std::string bytes;
};

struct Export {
  std::vector<ExportFile> files;   // the first is -o itself
  std::vector<std::string> notes;  // a sentence each: what the format does not hold
  std::string stem_mark = {};      // in a file that names another: stands for -o's name without its ending
};

// The source as a GLB (read_as_glb), and of each of the asset's bones its node in it; -1 where there is none.
struct SourceGlb {
  std::string bytes;
  std::vector<int> node_of_bone;
};

Export export_json(const Colliders& colliders);
// Written into the source; nothing else of it changes.
Export export_vrm(const Colliders& colliders, const SourceGlb& source);
Export export_khr(const Colliders& colliders,
                  const SourceGlb& source);  // KHR_implicit_shapes, KHR_physics_rigid_bodies
Export export_omi(const Colliders& colliders, const SourceGlb& source);  // OMI_physics_shape, OMI_physics_body
Export export_mjcf(const Colliders& colliders);
Export export_urdf(const Colliders& colliders);    // with an SRDF beside it
Export export_xrdf(const Colliders& colliders);    // with its URDF
Export export_curobo(const Colliders& colliders);  // with its URDF
Export export_usd(const Colliders& colliders);
Export export_godot(const Colliders& colliders);   // with a script
Export export_unity(const Colliders& colliders);   // JSON with an importer in C#
Export export_unreal(const Colliders& colliders);  // JSON with a script of the editor's Python

}  // namespace spherechain::baker
