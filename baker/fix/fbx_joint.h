// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <set>
#include <string>
#include <vector>

#include "baker/fix/fbx_animation.h"
#include "baker/fix/fbx_curve.h"
#include "baker/mesh/euler.h"
#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// A joint's rotation in an FBX file: angles about its axes, between a turn before and one after them.
class JointAngles {
 public:
  explicit JointAngles(const FbxObject& model);

  // `degrees` are about x, y and z.
  Eigen::Quaterniond rotation(const Vec3& degrees) const;
  // The angles nearest to `near` that give a rotation.
  Vec3 degrees(const Eigen::Quaterniond& rotation, const Vec3& near) const;
  // From the pivot that the joint turns about to its origin, in its own axes.
  const Vec3& arm() const { return arm_; }

 private:
  Vec3 ordered(const Vec3& degrees) const { return {degrees[axes_[0]], degrees[axes_[1]], degrees[axes_[2]]}; }

  EulerAxes axes_;
  Eigen::Quaterniond before_, after_;
  Vec3 arm_;
};

// A property of a model, "Lcl Rotation" or "Lcl Translation", and its keys before and after.
class AnimatedProperty {
 public:
  // Throws Error(kFile) that begins with `file` if its curves are damaged, or not its own.
  AnimatedProperty(const FbxFile& fbx, const FbxAnimation& animation, const FbxObject& model, const std::string& name,
                   const std::string& file);

  const FbxObject& model() const { return model_; }
  const std::string& name() const { return name_; }
  const FbxAnimation::Track& track() const { return track_; }
  const std::vector<FbxCurve>& after() const { return after_; }
  // The value where no curve says another: the curve node's.
  const Vec3& still() const { return still_; }

  // The value before, with other values for axes without a curve or without.
  Vec3 at(std::int64_t tick) const { return at(tick, still_); }
  Vec3 at(std::int64_t tick, const Vec3& still) const;
  // The times at which a curve has a key before.
  std::set<std::int64_t> ticks() const;
  bool is_key_of_all(std::int64_t tick) const;

  // Sets a key in each curve. Keys that do not change stay as they are written.
  void set(std::int64_t tick, const Vec3& value, bool changes);
  // Makes lines that lead to the keys set from `first` to `last`, and away from them: those of before, so that each
  // curve gets a key where another has one.
  void lead(std::int64_t first, std::int64_t last);

 private:
  const FbxObject& model_;
  std::string name_;
  FbxAnimation::Track track_;
  Vec3 still_;
  std::vector<FbxCurve> before_, after_;
};

}  // namespace spherechain::baker
