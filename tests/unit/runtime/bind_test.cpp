// SPDX-License-Identifier: MIT
// From an engine's joints to the bones of an asset: binding, gathering, placing, and the self-check at rest.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <string>

#include "jobs.h"
#include "palette.h"
#include "random_poses.h"
#include "runtime/src/pose/pose.h"
#include "tiny_skin.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kRigBones = 6;  // the last is the rest bone

// A character with turned inverse bind matrices, and an engine's skeleton: the same joints backwards, and one more.
struct Rig {
  explicit Rig(MatrixLayout joint_layout = SC_COLUMNS_4X4) : tiny(random_band(11, 1)), layout(joint_layout) {
    skin = add_bones(tiny, kRigBones, 2);
    std::mt19937 random(3);
    for (std::size_t b = 0; b + 1 < kRigBones; ++b) {
      tiny.parts.bones[b].inverse_bind = random_pose(1, PoseKind::kRigid, 1, random)[0];
    }
    add_skin(tiny, &skin, 4);
    opened = std::make_unique<OpenedAsset>(tiny.parts);
    REQUIRE_MESSAGE(opened->status == SC_OK, opened->message);
    binds.resize(16 * kRigBones, 0);
    names = {"extra"};
    for (std::size_t j = 1; j < kRigBones; ++j) {
      const BoneEntry& bone = tiny.parts.bones[kRigBones - 1 - j];
      names.push_back(bone.name);
      put_matrix(bone.inverse_bind, layout, &binds[16 * j]);
    }
    for (std::size_t j = 0; j < kRigBones; ++j) joints.push_back({names[j].c_str(), &binds[16 * j]});
  }
  sc_status bind() {
    message.assign(160, '\0');
    const sc_status status = sc_bind_joints(&opened->asset, joints.data(), joints.size(), layout, joint_of_bone.data(),
                                            joint_of_bone.size(), message.data(), message.size());
    message.resize(message.find('\0'));
    return status;
  }
  // The matrices of a pose in the engine's order.
  std::vector<Matrix> palette_of(const std::vector<Matrix>& bones) const {
    std::vector<Matrix> out(kRigBones);
    out[0].fill(kNan);
    for (std::size_t j = 1; j < kRigBones; ++j) out[j] = bones[kRigBones - 1 - j];
    return out;
  }

  TinyAsset tiny;
  TinySkin skin;
  std::unique_ptr<OpenedAsset> opened;
  MatrixLayout layout;
  std::vector<float> binds;
  std::vector<std::string> names;
  std::vector<sc_bone> joints;
  std::vector<std::uint32_t> joint_of_bone = std::vector<std::uint32_t>(kRigBones, 77);
  std::string message;
};

constexpr Matrix kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

// A pose of the bones; the rest bone has the identity, as sc_gather_bones() gives it.
std::vector<Matrix> random_bones(unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Matrix> bones = random_pose(kRigBones, PoseKind::kGentle, 1, random);
  bones.back() = kIdentity;
  return bones;
}

}  // namespace

TEST_CASE("joints are bound by name, in any order, with inverse bind matrices of any layout") {
  for (const MatrixLayout layout : kLayouts) {
    Rig rig(layout);
    CHECK_MESSAGE(rig.bind() == SC_OK, rig.message);
    CHECK(rig.joint_of_bone == std::vector<std::uint32_t>{5, 4, 3, 2, 1, SC_NO_JOINT});
  }
}

TEST_CASE("of several joints of one name the one with the asset's inverse bind matrix is taken") {
  Rig rig;
  rig.names[0] = "bone2";  // the extra joint, before the right one
  rig.joints[0].name = rig.names[0].c_str();
  CHECK(rig.bind() == SC_OK);
  CHECK(rig.joint_of_bone[2] == 3);
}

TEST_CASE("a bone that the skeleton lacks is named") {
  Rig rig;
  rig.names[3] = "Bone2";
  rig.joints[3].name = rig.names[3].c_str();
  CHECK(rig.bind() == sc_status{SC_NO_SUCH_BONE, SC_FIELD_JOINTS});
  CHECK(rig.message.find("\"bone2\"") != std::string::npos);
  rig.joints[3].name = nullptr;
  CHECK(rig.bind() == SC_NO_SUCH_BONE);
  CHECK(rig.message.find("but") == std::string::npos);
}

TEST_CASE("where a joint's name differs in case and punctuation alone, the message names it") {
  Rig rig;
  for (const char* name : {"Bone.2", "bone:2", "[BONE_2]"}) {
    rig.joints[3].name = name;
    CHECK(rig.bind() == SC_NO_SUCH_BONE);
    CHECK_MESSAGE(rig.message.find(std::string("but \"") + name + "\" is") != std::string::npos, rig.message);
  }
  for (const char* name : {"bone22", "bone", "", "..", "b\xC3\xB6ne2"}) {
    rig.joints[3].name = name;
    CHECK(rig.bind() == SC_NO_SUCH_BONE);
    CHECK_MESSAGE(rig.message.find("but") == std::string::npos, rig.message);
  }
}

TEST_CASE("another rest pose, and a transposed layout, are found while binding; rounding is not") {
  Rig rig;
  float* const place = &rig.binds[16 * 2 + 12];  // bone3's translation
  *place += 1.2e-3F;                             // less than a thousandth of the height
  CHECK(rig.bind() == SC_OK);
  *place += 0.1F;
  CHECK(rig.bind() == sc_status{SC_OTHER_BIND, SC_FIELD_JOINTS});
  CHECK(rig.message.find("\"bone3\"") != std::string::npos);
  *place -= 0.1F;
  rig.binds[16 * 2] += 0.1F;  // and its axes
  CHECK(rig.bind() == SC_OTHER_BIND);
  std::fill_n(&rig.binds[16 * 2], 16, std::numeric_limits<float>::quiet_NaN());
  CHECK(rig.bind() == SC_OTHER_BIND);
  rig.joints[2].inverse_bind = nullptr;  // not compared
  CHECK(rig.bind() == SC_OK);

  Rig other;
  other.layout = SC_ROWS_4X4;
  CHECK(other.bind() == SC_OTHER_BIND);
  other.layout = SC_LAYOUT_UNSET;
  CHECK(other.bind() == sc_status{SC_BAD_VALUE, SC_FIELD_BONE_LAYOUT});
}

TEST_CASE("binding names what it cannot use, also with no room for a message") {
  Rig rig;
  const Asset closed{};
  const auto bind = [&](const Asset* asset, const sc_bone* joints, std::uint32_t* out, std::size_t room) {
    return sc_bind_joints(asset, joints, joints == nullptr ? 1 : kRigBones, rig.layout, out, room, nullptr, 0);
  };
  std::uint32_t* const out = rig.joint_of_bone.data();
  CHECK(bind(nullptr, rig.joints.data(), out, kRigBones) == sc_status{SC_NULL, SC_FIELD_ASSET});
  CHECK(bind(&closed, rig.joints.data(), out, kRigBones) == sc_status{SC_NOT_OPEN, SC_FIELD_ASSET});
  CHECK(bind(&rig.opened->asset, nullptr, out, kRigBones) == sc_status{SC_NULL, SC_FIELD_JOINTS});
  CHECK(bind(&rig.opened->asset, rig.joints.data(), nullptr, kRigBones) == sc_status{SC_NULL, SC_FIELD_OUTPUT});
  CHECK(bind(&rig.opened->asset, rig.joints.data(), out, kRigBones - 1) == sc_status{SC_TOO_SMALL, SC_FIELD_OUTPUT});
  CHECK(rig.joint_of_bone == std::vector<std::uint32_t>(kRigBones, 77));
}

TEST_CASE("a gathered palette has the asset's order and layout, and the identity for the rest bone") {
  Rig rig;
  REQUIRE(rig.bind() == SC_OK);
  const std::vector<Matrix> bones = random_bones(5);
  for (const MatrixLayout layout : kLayouts) {
    for (const std::size_t padding : {0U, 3U}) {
      const Palette palette(rig.palette_of(bones), layout, padding);
      std::vector<Matrix> out(kRigBones);
      const Pose pose = palette.pose();
      CHECK(sc_gather_bones(&rig.opened->asset, rig.joint_of_bone.data(), &pose, out[0].data()) == SC_OK);
      CHECK(same_bits(out, bones));
    }
  }
}

TEST_CASE("placed bones move what they moved, by the transform") {
  // Stretches along each axis, then a quarter turn about (2, 3, 6), then a shift.
  const double axis[3] = {2 / 7.0, 3 / 7.0, 6 / 7.0}, shift[3] = {3, -1, 2};
  const Transform place{{3, -1, 2}, {0.2020305F, 0.3030458F, 0.6060915F, 0.7071068F}, {2, 3, 4}};
  const std::vector<Matrix> bones = random_bones(6);
  std::vector<Matrix> placed = bones;
  REQUIRE(sc_place_bones(&place, placed[0].data(), placed.size()) == SC_OK);
  for (std::size_t b = 0; b < bones.size(); ++b) {
    for (std::size_t column = 0; column < 4; ++column) {
      const double v[3] = {2.0 * bones[b][column], 3.0 * bones[b][4 + column], 4.0 * bones[b][8 + column]};
      const double along = axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2];
      for (std::size_t k = 0, l = 1, m = 2; k < 3; ++k, l = m, m = 3 - k - l) {
        const double turned = axis[k] * along + axis[l] * v[m] - axis[m] * v[l];
        CHECK(placed[b][4 * k + column] == doctest::Approx(turned + (column == 3 ? shift[k] : 0)));
      }
    }
  }
  placed = bones;
  const Transform none{{}, {}, {1, 1, 1}};
  CHECK(sc_place_bones(&none, placed[0].data(), placed.size()) == Status{SC_BAD_VALUE, SC_FIELD_TRANSFORM});
  CHECK(sc_place_bones(nullptr, placed[0].data(), placed.size()) == Status{SC_NULL, SC_FIELD_TRANSFORM});
  CHECK(sc_place_bones(&place, nullptr, 1) == Status{SC_NULL, SC_FIELD_BONES});
  CHECK(same_bits(placed, bones));
}

TEST_CASE("gathering names what it cannot use and writes nothing") {
  Rig rig;
  REQUIRE(rig.bind() == SC_OK);
  const std::vector<Matrix> engine = rig.palette_of(random_bones(5));
  const Asset closed{};
  std::vector<float> out(12 * kRigBones, 7);
  const std::uint32_t* const map = rig.joint_of_bone.data();
  const auto gather = [&](auto spoil) {
    Pose pose = pose_of(engine);
    spoil(pose);
    return sc_gather_bones(&rig.opened->asset, map, &pose, out.data());
  };
  const Pose good = pose_of(engine);
  CHECK(sc_gather_bones(nullptr, map, &good, out.data()) == sc_status{SC_NULL, SC_FIELD_ASSET});
  CHECK(sc_gather_bones(&closed, map, &good, out.data()) == sc_status{SC_NOT_OPEN, SC_FIELD_ASSET});
  CHECK(sc_gather_bones(&rig.opened->asset, nullptr, &good, out.data()) == sc_status{SC_NULL, SC_FIELD_JOINTS});
  CHECK(sc_gather_bones(&rig.opened->asset, map, nullptr, out.data()) == sc_status{SC_NULL, SC_FIELD_BONES});
  CHECK(sc_gather_bones(&rig.opened->asset, map, &good, nullptr) == sc_status{SC_NULL, SC_FIELD_OUTPUT});
  CHECK(gather([](Pose& p) { p.bones = nullptr; }) == sc_status{SC_NULL, SC_FIELD_BONES});
  CHECK(gather([](Pose& p) { p.bone_layout = SC_LAYOUT_UNSET; }) == sc_status{SC_BAD_VALUE, SC_FIELD_BONE_LAYOUT});
  CHECK(gather([](Pose& p) { p.bone_stride = 44; }) == sc_status{SC_BAD_STRIDE, SC_FIELD_BONE_STRIDE});
  CHECK(gather([](Pose& p) { p.bone_count = 5; }) == sc_status{SC_TOO_SMALL, SC_FIELD_BONE_COUNT});
  auto* const askew = reinterpret_cast<float*>(reinterpret_cast<std::uintptr_t>(out.data()) + 2);
  CHECK(sc_gather_bones(&rig.opened->asset, map, &good, askew) == sc_status{SC_MISALIGNED, SC_FIELD_OUTPUT});
  CHECK(out == std::vector<float>(12 * kRigBones, 7));
}

TEST_CASE("a pose's scale is that of its root part, and 1 where it is no size or differs by rounding") {
  AssetParts parts = Rig().tiny.parts;
  parts.parts[0].bone = -1;  // the root is the first part with a bone
  const OpenedAsset opened(parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  const std::pair<float, double> sizes[] = {{2, 2}, {1.9995F, 1.9995}, {1.0005F, 1}, {0, 1}, {kNan, 1}, {kInfinity, 1}};
  for (const auto& [size, expected] : sizes) {
    std::vector<Matrix> bones(kRigBones, kIdentity);
    bones[1] = {size, 0, 0, 0, 0, 0, -size, 0, 0, size, 0, 0};
    CHECK(scale_of(opened.view(), pose_of(bones)) == doctest::Approx(expected));
  }
}

TEST_CASE("in the bind pose all bones have the model's matrix; the first that has not is named") {
  Rig rig;
  const auto check = [&](const Pose& pose) {
    rig.message.assign(160, '\0');
    const sc_status status = check_rest_pose(rig.opened->asset, pose, rig.message.data(), rig.message.size());
    rig.message.resize(rig.message.find('\0'));
    return status;
  };
  std::mt19937 random(4);
  const Matrix model = random_pose(1, PoseKind::kRigid, 50, random)[0];
  std::vector<Matrix> bones(kRigBones, model);
  bones.back() = kIdentity;  // the rest bone's own
  for (const MatrixLayout layout : kLayouts) {
    const Palette palette(bones, layout, 0);
    CHECK(check(palette.pose()) == SC_OK);
  }
  // Rounding is no difference, a hundredth of the height is.
  bones[2][3] += 1e-4F;
  CHECK(check(pose_of(bones)) == SC_OK);
  bones[2][3] += 0.0175F;
  CHECK(check(pose_of(bones)) == sc_status{SC_OTHER_BIND, SC_FIELD_BONES});
  CHECK(rig.message.find("\"bone2\"") != std::string::npos);
  bones[2] = model;
  bones[4][0] = kNan;
  CHECK(check(pose_of(bones)) == SC_OTHER_BIND);
  bones[4] = model;
  // Matrices of 4 by 4 read as 3 by 4.
  const Palette larger(bones, SC_ROWS_4X4, 0);
  Pose wrong = larger.pose();
  wrong.bone_layout = SC_ROWS_3X4;
  wrong.bone_stride = 0;
  CHECK(check(wrong) == SC_OTHER_BIND);
  // The other layout of 4 by 4: the translation is in the last row. And a palette that nobody filled.
  wrong.bone_layout = SC_COLUMNS_4X4;
  CHECK(check(wrong) == SC_OTHER_BIND);
  CHECK(rig.message.find("0 0 0 1") != std::string::npos);
  CHECK(check(pose_of(std::vector<Matrix>(kRigBones, Matrix{}))) == SC_OTHER_BIND);
  CHECK(rig.message.find("filled") != std::string::npos);
  // The status of a refused pose names its field.
  Pose short_pose = pose_of(bones);
  short_pose.bone_count = 2;
  CHECK(check(short_pose) == sc_status{SC_TOO_SMALL, SC_FIELD_BONE_COUNT});
  CHECK(rig.message.find("bone_count") != std::string::npos);
}

}  // namespace spherechain::test
