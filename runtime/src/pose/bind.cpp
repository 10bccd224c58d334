// SPDX-License-Identifier: MIT
// From an engine's joints to the asset's bones, and whether the two agree.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/src/base/message.h"
#include "runtime/src/base/status.h"
#include "runtime/src/pose/pose.h"

namespace spherechain {
namespace {

// Largest accepted difference of two inverse bind matrices, or of two places of a joint: engines store them in halves
// of a unit in the last place, exporters in six digits; another rest pose differs by far more.
constexpr double kTolerance = 1e-3;

// The greatest difference of two matrices: of the linear parts relative to the greatest figure, of the translations
// relative to the character's height.
struct Difference {
  double linear, translation;
};

Difference difference_of(const float* rows, const BoneMatrices& other, double height) {
  double greatest = 1e-30, linear = 0, translation = 0;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 4; ++c) {
      const double own = rows[4 * r + c], theirs = other.data[r * other.row + c * other.column];
      if (!std::isfinite(theirs)) {
        return {HUGE_VAL, HUGE_VAL};
      }
      if (c < 3) {
        greatest = std::max(greatest, std::abs(own));
        linear = std::max(linear, std::abs(own - theirs));
      } else {
        translation = std::max(translation, std::abs(own - theirs));
      }
    }
  }
  return {linear / greatest, translation / (greatest * height)};
}

bool agrees(const Difference& d) { return d.linear <= kTolerance && d.translation <= kTolerance; }

// The next character of a name that counts where names are alike: a letter in lower case, a digit, a byte of UTF-8.
char next_counting(const char*& name) {
  while (*name != '\0') {
    const char c = *name++;
    if (c >= 'A' && c <= 'Z') {
      return static_cast<char>(c - 'A' + 'a');
    }
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || static_cast<unsigned char>(c) >= 0x80) {
      return c;
    }
  }
  return '\0';
}

// Loaders change names: three.js makes FootL of Foot.L, and mixamorigHips of mixamorig:Hips.
bool are_alike(const char* a, const char* b) {
  for (;;) {
    const char c = next_counting(a);
    if (c != next_counting(b)) {
      return false;
    }
    if (c == '\0') {
      return true;
    }
  }
}

// Where matrix `bone` of a pose takes a point.
void move(const BoneMatrices& bones, std::size_t bone, const Vec3& p, double (&out)[3]) {
  const float* const m = bones.data + bone * bones.stride;
  for (std::size_t r = 0; r < 3; ++r) {
    const float* const row = m + r * bones.row;
    out[r] = double{row[0]} * p.x + double{row[bones.column]} * p.y + double{row[2 * bones.column]} * p.z +
             row[3 * bones.column];
  }
}

// Whether the last row of a matrix of 4 by 4 holds a translation. Nothing else reads that row.
bool is_transposed(const Pose& pose, const BoneMatrices& bones, std::size_t bone) {
  if (size_of(pose.bone_layout) != 16 * sizeof(float)) {
    return false;
  }
  const float* const last = bones.data + bone * bones.stride + 3 * bones.row;
  constexpr float kNone = 1e-3F;
  return std::abs(last[0]) > kNone || std::abs(last[bones.column]) > kNone || std::abs(last[2 * bones.column]) > kNone;
}

}  // namespace

Status check_rest_pose(const Asset& asset, const Pose& pose, char* message, std::size_t message_size) {
  Message sentence(message, message_size);
  const AssetView& view = view_of(asset);
  const Status status = check_bones(view, pose);
  if (status != SC_OK) {
    sentence.wrong("%s: %s", sc_field_name(status.field), sc_code_text(status.code));
    return status;
  }
  // All matrices are the model's own: each moves the body's middle, and points a height off, where the first one does.
  const BoneMatrices bones = matrices_of(pose);
  const AssetInfo info = view.info();
  const float h = info.height;
  const Vec3 o = info.origin;
  const Vec3 points[] = {o, {o.x + h, o.y, o.z}, {o.x, o.y + h, o.z}, {o.x, o.y, o.z + h}};
  double first[4][3], moved[3];
  for (std::size_t i = 0; i < 4; ++i) {
    move(bones, 0, points[i], first[i]);
  }
  double scale = 0;
  for (std::size_t r = 0; r < 3; ++r) {
    scale = std::max(scale, std::abs(first[2][r] - first[0][r]));
  }
  for (std::size_t b = 0; b < view.bone_count(); ++b) {
    if (is_transposed(pose, bones, b)) {
      sentence.wrong("bone \"%s\": the last row of its matrix is not 0 0 0 1. Is the layout the other one of 4 by 4?",
                     view.bone(b).name);
      return refuse(SC_OTHER_BIND, SC_FIELD_BONES);
    }
    if (scale == 0) {
      sentence.wrong("bone \"%s\": its matrix moves all points to one place. Has the palette been filled?",
                     view.bone(0).name);
      return refuse(SC_OTHER_BIND, SC_FIELD_BONES);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      move(bones, b, points[i], moved);
      for (std::size_t r = 0; r < 3; ++r) {
        if (!(std::abs(moved[r] - first[i][r]) <= kTolerance * scale) && !view.bone(b).is_rest) {
          sentence.wrong(
              "bone \"%s\": its matrix is not that of \"%s\", as in the bind pose. Is this the bind pose? "
              "Are layout, order and inverse bind matrices right?",
              view.bone(b).name, view.bone(0).name);
          return refuse(SC_OTHER_BIND, SC_FIELD_BONES);
        }
      }
    }
  }
  return done();
}

}  // namespace spherechain

using namespace spherechain;

extern "C" {

sc_status sc_bind_joints(const sc_asset* asset, const sc_bone* joints, size_t joint_count,
                         sc_matrix_layout inverse_bind_layout, uint32_t* joint_of_bone, size_t capacity, char* message,
                         size_t message_size) noexcept {
  Message sentence(message, message_size);
  if (!is_open(asset)) {
    sentence.wrong("asset: not open");
    return refuse(asset == nullptr ? SC_NULL : SC_NOT_OPEN, SC_FIELD_ASSET);
  }
  const AssetView& view = view_of(*asset);
  if ((joints == nullptr && joint_count > 0) || joint_of_bone == nullptr) {
    sentence.wrong("%s: null", joint_of_bone == nullptr ? "joint_of_bone" : "joints");
    return refuse(SC_NULL, joint_of_bone == nullptr ? SC_FIELD_OUTPUT : SC_FIELD_JOINTS);
  }
  if (capacity < view.bone_count()) {
    sentence.wrong("joint_of_bone: room for %zu bones, but the asset has %zu", capacity, view.bone_count());
    return refuse(SC_TOO_SMALL, SC_FIELD_OUTPUT);
  }
  const double height = view.info().height;
  for (std::size_t b = 0; b < view.bone_count(); ++b) {
    const BoneView bone = view.bone(b);
    joint_of_bone[b] = SC_NO_JOINT;
    if (bone.is_rest) {
      continue;
    }
    bool is_there = false;
    Difference least{HUGE_VAL, HUGE_VAL};
    for (std::size_t j = 0; j < joint_count && !agrees(least); ++j) {
      if (joints[j].name == nullptr || std::strcmp(joints[j].name, bone.name) != 0) {
        continue;
      }
      is_there = true;
      Difference d{};
      if (joints[j].inverse_bind != nullptr) {
        if (size_of(inverse_bind_layout) == 0) {
          sentence.wrong("inverse_bind_layout: not set, but joint \"%s\" has an inverse bind matrix", bone.name);
          return refuse(SC_BAD_VALUE, SC_FIELD_BONE_LAYOUT);
        }
        d = difference_of(bone.inverse_bind, matrices_of(Pose{joints[j].inverse_bind, 1, inverse_bind_layout}), height);
      }
      if (agrees(d) || d.linear + d.translation < least.linear + least.translation) {
        least = d;
        joint_of_bone[b] = static_cast<std::uint32_t>(j);
      }
    }
    if (agrees(least)) {
      continue;
    }
    if (!is_there) {
      const sc_bone* const alike = std::find_if(joints, joints + joint_count, [&](const sc_bone& joint) {
        return joint.name != nullptr && are_alike(joint.name, bone.name);
      });
      if (alike != joints + joint_count) {
        sentence.wrong(
            "bone \"%s\" of the asset is no joint of this skeleton, but \"%s\" is: did a loader change the name?",
            bone.name, alike->name);
      } else {
        sentence.wrong("bone \"%s\" of the asset is no joint of this skeleton", bone.name);
      }
      return refuse(SC_NO_SUCH_BONE, SC_FIELD_JOINTS);
    }
    sentence.wrong(
        "bone \"%s\": its inverse bind matrix differs from the asset's (axes by %.3g, place by %.3g of the "
        "height): another rest pose, unit or axis convention",
        bone.name, least.linear, least.translation);
    return refuse(SC_OTHER_BIND, SC_FIELD_JOINTS);
  }
  return done();
}

sc_status sc_gather_bones(const sc_asset* asset, const uint32_t* joint_of_bone, const sc_pose* palette,
                          float* bones) noexcept {
  if (!is_open(asset)) {
    return refuse(asset == nullptr ? SC_NULL : SC_NOT_OPEN, SC_FIELD_ASSET);
  }
  if (palette == nullptr || palette->bones == nullptr || joint_of_bone == nullptr || bones == nullptr) {
    return refuse(SC_NULL, bones == nullptr           ? SC_FIELD_OUTPUT
                           : joint_of_bone == nullptr ? SC_FIELD_JOINTS
                                                      : SC_FIELD_BONES);
  }
  if (any_misaligned(bones)) {
    return refuse(SC_MISALIGNED, SC_FIELD_OUTPUT);
  }
  const Status status = check_matrices(*palette);
  if (status != SC_OK) {
    return status;
  }
  const std::size_t count = view_of(*asset).bone_count();
  for (std::size_t b = 0; b < count; ++b) {
    if (joint_of_bone[b] != SC_NO_JOINT && joint_of_bone[b] >= palette->bone_count) {
      return refuse(SC_TOO_SMALL, SC_FIELD_BONE_COUNT);
    }
  }
  const BoneMatrices from = matrices_of(*palette);
  for (std::size_t b = 0; b < count; ++b) {
    for (std::size_t i = 0; i < 12; ++i) {
      const std::size_t row = i / 4, column = i % 4;
      bones[12 * b + i] = joint_of_bone[b] == SC_NO_JOINT
                              ? static_cast<float>(row == column)
                              : from.data[joint_of_bone[b] * from.stride + row * from.row + column * from.column];
    }
  }
  return done();
}

}  // extern "C"
