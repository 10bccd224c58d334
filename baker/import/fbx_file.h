// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace spherechain::baker {

// The objects of an FBX file that assimp mixes up: see fbx_names.h and fbx_curves.h.
enum class FbxKind { kModel, kCurves, kStack };
struct FbxObject {
  std::int64_t id = 0;
  std::string_view name;                                // in the file's bytes, without its kind
  FbxKind kind = FbxKind::kModel;                       // kCurves: those of a property; kStack: an animation
  bool is_joint = false;                                // a model of a skeleton
  std::map<std::string, std::array<double, 3>> values;  // properties of one number or three, by name
};

// `child` belongs to `parent`, or to that property of it.
struct FbxLink {
  std::int64_t child, parent;
  std::string property;
};

struct FbxFile {
  std::vector<FbxObject> objects;
  std::vector<FbxLink> links;
};

bool is_fbx(std::string_view bytes);

// Binary or text, of version 7 or later. Records that are not understood are left out; a damaged record ends the list
// that it is in. Names lead into `bytes`.
FbxFile read_fbx(std::string_view bytes);

}  // namespace spherechain::baker
