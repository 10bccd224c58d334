// SPDX-License-Identifier: MIT
// As much of Godot as the addon asks for, behind the functions of its extension interface: values, three node classes,
// files. It counts the values that are alive, so a trial sees what the addon forgets to free.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "runtime/godot/gdextension.h"

namespace fake {

using namespace spherechain::godot;

struct Node {  // every Object
  std::string class_name;
  uint64_t id = 0;
  int references = 0;
  void* instance = nullptr;  // of an extension's class
  void* binding = nullptr;
  std::vector<Node*> children;
  Node* skin = nullptr;  // of a mesh
  struct Bone {          // of a skeleton: at rest turned as its parent; of a skin: `name` and `inverse_bind`
    std::string name;
    int parent = -1;
    Vector3 position;
    Quaternion rotation;
    Transform3D inverse_bind;
  };
  std::vector<Bone> bones;
  int turned = 0;  // calls of set_bone_pose_rotation
};

struct Class {
  ClassInfo2 info;
  struct Method {
    MethodInfo info;
    int32_t argument;
    std::string argument_class;
  };
  std::map<std::string, Method> methods;
};

extern std::map<std::string, Class> classes;
extern std::vector<std::string> errors;
extern int64_t alive;  // strings, names, arrays, dictionaries, transforms

Node* make_node(const std::string& class_name);
void forget(Node* node);  // as a freed node: its id leads nowhere
void* get_proc_address(const char* name);
Transform3D global_pose(const Node& skeleton, int bone);

// Values in the format of the interface.
Variant of_text(const std::string& text);
Variant of_node(Node* node);
Variant of_int(int64_t value);
Variant of_float(double value);
std::string text_of(const Variant& value);
int64_t int_of(const Variant& value);
double float_of(const Variant& value);
std::vector<Variant>& items_of(Variant& array);
Variant item_of(Variant& dictionary, const std::string& key);  // not a copy
void destroy(Variant& value);

}  // namespace fake
