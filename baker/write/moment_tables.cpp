// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/write/moment_tables.h"

#include <array>

#include "baker/write/schema_values.h"
#include "runtime/src/asset/moment_tables.h"

namespace spherechain::baker {
namespace {

static_assert(kMaxMomentBones == spherechain::kMaxMomentBones);

schema::Matrix matrix_of(const Affine& affine) {
  std::array<float, 12> elements{};
  for (std::size_t i = 0; i < elements.size(); ++i) {
    elements[i] =
        static_cast<float>(affine.matrix()(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)));
  }
  return schema::Matrix(flatbuffers::span<const float, 12>(elements.data(), elements.size()));
}

schema::Moment moment_of(const Eigen::Matrix4d& moment) {
  std::array<float, kMomentSize> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<float>(moment(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)));
  }
  return schema::Moment(span_of(values));
}

// Symmetric, as the Gram matrix that it is taken with: what is below the diagonal goes above it.
Eigen::Matrix4d upper_of(const Eigen::Matrix4d& moment) {
  Eigen::Matrix4d out = 2 * moment;
  out.diagonal() = moment.diagonal();
  return out.triangularView<Eigen::Upper>();
}

schema::CenterTerm center_of(const Eigen::Vector4d& center) {
  const Eigen::Vector4f single = center.cast<float>();
  return {single.x(), single.y(), single.z(), single.w()};
}

}  // namespace

std::vector<flatbuffers::Offset<schema::Bone>> create_bones(flatbuffers::FlatBufferBuilder& builder,
                                                            const BoneBinding& in) {
  std::vector<flatbuffers::Offset<schema::Bone>> out;
  for (const MovingBone& bone : in.bones) {
    const schema::Matrix inverse_bind = matrix_of(bone.inverse_bind);
    out.push_back(schema::CreateBoneDirect(builder, bone.name.c_str(), &inverse_bind, bone.is_rest));
  }
  return out;
}

flatbuffers::Offset<schema::Moments> create_moments(flatbuffers::FlatBufferBuilder& builder, const MomentBinding& in) {
  if (in.batches.empty()) return 0;
  std::vector<schema::MomentBatch> batches;
  std::vector<schema::BonePair> pairs;
  std::vector<std::uint32_t> spheres;
  std::vector<std::uint8_t> bone_counts, places;
  std::vector<std::uint16_t> bones;
  std::vector<schema::CenterTerm> centers;
  std::vector<schema::Moment> moments;
  for (const MomentBatch& batch : in.batches) {
    batches.emplace_back(static_cast<std::uint32_t>(batch.pairs.size()),
                         static_cast<std::uint32_t>(batch.spheres.size()));
    for (const BonePair& pair : batch.pairs) {
      pairs.emplace_back(static_cast<std::uint16_t>(pair.first), static_cast<std::uint16_t>(pair.second));
    }
    for (const SphereMoments& sphere : batch.spheres) {
      spheres.push_back(sphere.sphere);
      bone_counts.push_back(static_cast<std::uint8_t>(sphere.bones.size()));
      for (const Index bone : sphere.bones) bones.push_back(static_cast<std::uint16_t>(bone));
      for (const Eigen::Vector4d& center : sphere.centers) centers.push_back(center_of(center));
      places.insert(places.end(), sphere.places.begin(), sphere.places.end());
      for (std::size_t i = 0; i < sphere.moments.size(); ++i) {
        const BonePair& pair = batch.pairs[sphere.places[i]];
        const Eigen::Matrix4d& moment = sphere.moments[i];
        moments.push_back(moment_of(pair.first == pair.second ? upper_of(moment) : moment));
      }
    }
  }
  const schema::Vec3 origin = to_schema(in.origin);
  const auto batches_at = builder.CreateVectorOfStructs(batches);
  const auto pairs_at = builder.CreateVectorOfStructs(pairs);
  const auto spheres_at = builder.CreateVector(spheres);
  const auto bone_counts_at = builder.CreateVector(bone_counts);
  const auto bones_at = builder.CreateVector(bones);
  // Nothing straddles two cache lines. (ForceVectorAlignment would do the same, but asserts 32 bytes at most.)
  builder.PreAlign(centers.size() * sizeof(schema::CenterTerm), sizeof(schema::CenterTerm));
  const auto centers_at = builder.CreateVectorOfStructs(centers);
  const auto places_at = builder.CreateVector(places);
  builder.PreAlign(moments.size() * sizeof(schema::Moment), sizeof(schema::Moment));
  const auto moments_at = builder.CreateVectorOfStructs(moments);
  return schema::CreateMoments(builder, &origin, in.reference, batches_at, pairs_at, spheres_at, bone_counts_at,
                               bones_at, centers_at, places_at, moments_at);
}

}  // namespace spherechain::baker
