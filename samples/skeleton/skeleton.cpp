// SPDX-License-Identifier: MIT
#include "skeleton.h"

#include <cmath>
#include <cstring>

namespace spherechain::samples {
namespace {

constexpr float kRadians = 0.0174532925F;

using Rotation = std::array<float, 9>;  // rows

Rotation rotation_of(const Vec3& v) {
  const float angle = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  if (angle == 0.0F) {
    return {1, 0, 0, 0, 1, 0, 0, 0, 1};
  }
  const float x = v.x / angle, y = v.y / angle, z = v.z / angle;
  const float c = std::cos(angle), s = std::sin(angle), t = 1.0F - c;
  return {c + t * x * x,     t * x * y - s * z, t * x * z + s * y,  //
          t * x * y + s * z, c + t * y * y,     t * y * z - s * x,  //
          t * x * z - s * y, t * y * z + s * x, c + t * z * z};
}

// p -> r (p - about) + about, after `matrix`.
void rotate(std::array<float, 12>& matrix, const Rotation& r, const Vec3& about) {
  const float centre[3] = {about.x, about.y, about.z};
  const std::array<float, 12> from = matrix;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      float sum = column == 3 ? centre[row] : 0.0F;
      for (std::size_t k = 0; k < 3; ++k) {
        sum += r[3 * row + k] * (from[4 * k + column] - (column == 3 ? centre[k] : 0.0F));
      }
      matrix[4 * row + column] = sum;
    }
  }
}

}  // namespace

bool has_automatic_rig(const Asset& asset) {
  if (asset.joint_count() == 0 || asset.bone_count() < asset.joint_count()) {
    return false;
  }
  for (std::size_t i = 0; i < asset.joint_count(); ++i) {
    if (std::strcmp(asset.joint(i).name, asset.bone(i).name) != 0) {
      return false;
    }
  }
  return true;
}

Palette rest_pose(const Asset& asset) { return Palette(asset.bone_count(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}); }

std::size_t find_joint(const Asset& asset, const char* name) {
  std::size_t i = 0;
  while (i < asset.joint_count() && std::strcmp(asset.joint(i).name, name) != 0) {
    ++i;
  }
  return i;
}

Vec3 position_of(const Asset& asset, const Palette& palette, std::size_t joint) {
  const Vec3 p = asset.joint(joint).position;
  const std::array<float, 12>& m = palette[joint];
  return {m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
          m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
}

void turn(const Asset& asset, Palette& palette, std::size_t joint, const Vec3& rotation) {
  if (joint >= asset.joint_count()) {
    return;
  }
  const Vec3 about = position_of(asset, palette, joint);
  const Rotation r = rotation_of(rotation);
  std::vector<bool> hangs_on_it(asset.joint_count());
  for (std::size_t i = joint; i < asset.joint_count(); ++i) {  // parents come before their children
    const std::int32_t parent = asset.joint(i).parent;
    hangs_on_it[i] = i == joint || (parent >= 0 && hangs_on_it[static_cast<std::size_t>(parent)]);
    if (hangs_on_it[i]) {
      rotate(palette[i], r, about);
    }
  }
}

void turn(const Asset& asset, Palette& palette, const char* joint, const Vec3& degrees) {
  const AssetInfo info = asset.info();
  const float x = degrees.x * kRadians, y = degrees.y * kRadians, z = degrees.z * kRadians;
  turn(asset, palette, find_joint(asset, joint),
       {x * info.left.x + y * info.up.x + z * info.forward.x, x * info.left.y + y * info.up.y + z * info.forward.y,
        x * info.left.z + y * info.up.z + z * info.forward.z});
}

}  // namespace spherechain::samples
