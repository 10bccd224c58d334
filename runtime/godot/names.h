// SPDX-License-Identifier: MIT
// The methods of Godot's classes that the addon calls, by name.
#pragma once

#include "values.h"

namespace spherechain::godot {

struct Names {
#define SPHERECHAIN_NAME(name) Name name{#name};
  SPHERECHAIN_NAME(find_bone)
  SPHERECHAIN_NAME(get_bind_bone)
  SPHERECHAIN_NAME(get_bind_count)
  SPHERECHAIN_NAME(get_bind_name)
  SPHERECHAIN_NAME(get_bind_pose)
  SPHERECHAIN_NAME(get_bone_count)
  SPHERECHAIN_NAME(get_bone_global_pose)
  SPHERECHAIN_NAME(get_bone_name)
  SPHERECHAIN_NAME(get_bone_parent)
  SPHERECHAIN_NAME(get_bone_pose_position)
  SPHERECHAIN_NAME(get_bone_pose_rotation)
  SPHERECHAIN_NAME(get_bone_pose_scale)
  SPHERECHAIN_NAME(get_child)
  SPHERECHAIN_NAME(get_child_count)
  SPHERECHAIN_NAME(get_file_as_bytes)
  SPHERECHAIN_NAME(get_skin)
  SPHERECHAIN_NAME(is_class)
  SPHERECHAIN_NAME(push_back)
  SPHERECHAIN_NAME(set_bone_pose_rotation)
  SPHERECHAIN_NAME(size)
  SPHERECHAIN_NAME(FileAccess)
  SPHERECHAIN_NAME(RefCounted)
  SPHERECHAIN_NAME(SpherechainBody)
  SPHERECHAIN_NAME(SpherechainResponse)
#undef SPHERECHAIN_NAME
};

// They exist between register_classes() and unregister_classes().
const Names& names();

}  // namespace spherechain::godot
