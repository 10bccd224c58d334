// SPDX-License-Identifier: MIT
#include "classes.h"
#include "names.h"

namespace spherechain::godot {

static bool is_same(const Quaternion& a, const Quaternion& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w;
}

static sc_vec3 vector_of(const Vector3& v) { return {v.x, v.y, v.z}; }

bool SkeletonResponse::bind(Object* object) {
  response_ = Response();
  body_ = nullptr;
  owner_ = Value();
  SkeletonBody* const body = instance_of<SkeletonBody>(object);
  if (body == nullptr || !body->body()) {
    print_error("SpherechainResponse.bind: pass a SpherechainBody that is bound to a skeleton");
    return false;
  }
  ResponseDef def;
  def.parents = body->parents().data();
  def.joint_count = body->parents().size();
  response_ = Response(body->body(), def);
  if (!response_) {
    print_error(std::string("SpherechainResponse.bind: ") + field_name(response_.status()) + ": " +
                code_text(response_.status()));
    return false;
  }
  owner_ = Value::of_object(object);
  body_ = body;
  bound_ = body->generation();
  reset();
  joints_.assign(def.joint_count, {});
  animated_.assign(def.joint_count, {});
  corrected_.assign(def.joint_count, {2, 2, 2, 2});  // like no rotation
  return true;
}

int64_t SkeletonResponse::apply(double seconds) {
  Object* const object = body_ == nullptr || body_->generation() != bound_ ? nullptr : body_->skeleton();
  if (object == nullptr) {
    print_error("SpherechainResponse.apply: bind() a body first, again after the body's load() or bind()");
    return 0;
  }
  Value skeleton = Value::of_object(object);
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Value index = Value::of(static_cast<int64_t>(i));
    // A bone that nobody animated since still has the correction: the response starts from the animation.
    const Quaternion now = skeleton.call(names().get_bone_pose_rotation, index).as_quaternion();
    if (!is_same(now, corrected_[i])) animated_[i] = now;
    const Quaternion& q = animated_[i];
    joints_[i] = {vector_of(skeleton.call(names().get_bone_pose_position, index).as_vector3()),
                  {q.x, q.y, q.z, q.w},
                  vector_of(skeleton.call(names().get_bone_pose_scale, index).as_vector3())};
    corrected_[i] = now;
  }
  ResponseFrame frame;
  frame.joints = joints_.data();
  frame.seconds = static_cast<float>(seconds);
  if (response_.respond(state_, frame) != SC_OK) {
    print_error(std::string("SpherechainResponse.apply: ") + field_name(response_.status()) + ": " +
                code_text(response_.status()));
    return 0;
  }
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const float* const q = joints_[i].rotation;
    const Quaternion wanted{q[0], q[1], q[2], q[3]};
    if (is_same(wanted, corrected_[i])) continue;
    const Value index = Value::of(static_cast<int64_t>(i));
    skeleton.call(names().set_bone_pose_rotation, index, Value::of(wanted));
    corrected_[i] = skeleton.call(names().get_bone_pose_rotation, index).as_quaternion();
  }
  return frame.turned;
}

}  // namespace spherechain::godot
