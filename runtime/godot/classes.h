// SPDX-License-Identifier: MIT
// The two classes that scripts see. register.cpp lists their methods for Godot; README.md explains them.
#pragma once

#include <spherechain/spherechain.h>

#include <vector>

#include "values.h"

namespace spherechain::godot {

// SpherechainBody: an asset in the pose of a Skeleton3D. Positions and lengths are those of the skeleton's own space.
class SkeletonBody {
 public:
  bool load(const std::string& path);
  bool bind(Object* skeleton);
  // An Array of one Dictionary for each fault, the worst first. Empty where nothing is bound.
  Value penetrations();

  Object* skeleton() const { return api.object_get_instance_from_id(skeleton_); }
  Body& body() { return body_; }
  const std::vector<uint32_t>& parents() const { return parents_; }
  // Counts load() and bind(): what was made of the body before is of no use after them.
  uint32_t generation() const { return generation_; }

 private:
  void take_skins(Value& skeleton);
  bool set_pose(Value& skeleton);
  Value described(const Penetration& found);

  std::vector<uint64_t> asset_;  // the file, aligned
  std::size_t asset_size_ = 0;
  uint32_t generation_ = 0;
  uint64_t skeleton_ = 0;  // an id: scripts may free the node
  // One for each bone of the skeleton. Matrices are rows of four; a bone that no skin binds has none.
  std::vector<std::string> names_;
  std::vector<uint32_t> parents_;
  std::vector<float> inverse_binds_;
  std::vector<bool> is_bound_;
  std::vector<float> palette_;
  Model model_;
  Body body_;
};

// SpherechainResponse: turns arms and hands of a body's skeleton out of the body.
class SkeletonResponse {
 public:
  bool bind(Object* body);
  // How many bones were turned.
  int64_t apply(double seconds);
  void reset() { state_ = {}; }

 private:
  Value owner_;  // keeps the SpherechainBody
  SkeletonBody* body_ = nullptr;
  uint32_t bound_ = 0;  // the body's generation
  Response response_;
  ResponseState state_;
  std::vector<Transform> joints_;
  std::vector<Quaternion> animated_, corrected_;  // of the last frame
};

// The instance behind an object of one of the two classes, or null.
template <typename T>
T* instance_of(Object* object);
template <>
SkeletonBody* instance_of(Object* object);

void register_classes();
void unregister_classes();

}  // namespace spherechain::godot
