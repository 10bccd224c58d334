// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "baker/import/fbx_tree.h"

namespace spherechain::baker {

// The objects of an FBX file that fbx_names.h, fbx_curves.h and the fix of an FBX character work on. An animation is a
// stack of layers. A layer has a curve node for each property that it animates, and that a curve for each axis.
enum class FbxKind { kModel, kCurveNode, kCurve, kLayer, kStack };
struct FbxObject {
  std::int64_t id = 0;
  std::string_view name;  // in the file's bytes, without its kind
  FbxKind kind = FbxKind::kModel;
  bool is_joint = false;                                // a model of a skeleton
  std::map<std::string, std::array<double, 3>> values;  // properties of one number or three, by name
  const FbxRecord* record = nullptr;                    // in the file's tree

  // A property's numbers; `otherwise` where the file does not say.
  std::array<double, 3> value(const std::string& property, const std::array<double, 3>& otherwise = {}) const;
};

// `child` belongs to `parent`, or to that property of it.
struct FbxLink {
  std::int64_t child, parent;
  std::string property;
};

struct FbxFile {
  FbxTree tree;
  std::vector<FbxObject> objects;
  std::vector<FbxLink> links;
};

// Binary or text, of version 7 or later. Records that are not understood are left out; a damaged record ends the list
// that it is in. Names lead into `bytes`.
FbxFile read_fbx(std::string_view bytes);

// The axes about which the angles of a model turn, the first turn first. An order that is no Euler angles (6: spheric)
// is read as 0, which assimp does.
std::array<int, 3> rotation_order(const FbxObject& model);

}  // namespace spherechain::baker
