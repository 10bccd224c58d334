// SPDX-License-Identifier: MIT
// Questions about a batch of poses, and the gradients of depths.
#pragma once

#include "loaded_asset.h"
#include "poses.h"

namespace spherechain::python {

// Where the skin is in each pose: by matrices, or by vertices. Strides in floats.
struct SkinPoses {
  std::size_t count = 0;
  Poses<float> bones{};                  // data null: none
  const float* vertices = nullptr;       // null: none; x, y, z of each of the source's, side by side
  const float* morph_weights = nullptr;  // null: none; of each target, pose by pose
};

enum class Question { kPenetrations, kContacts, kSteps, kGround, kBounds };

struct Asked {
  Question question;
  Query query;
  const LoadedAsset* other = nullptr;  // null: each pose with itself
  SkinPoses others;                    // the poses of `other`, as many as are asked about
  SkinPoses before, others_before;     // where a step comes from
  Ground ground;
};

// The entries of all poses, one pose after the other, as bytes: those of pose i start at first[i] and end at first[i +
// 1].
struct Runs {
  std::vector<std::uint8_t> bytes;
  std::vector<std::size_t> first{0};
};

// The first list has penetrations, steps, contacts of body parts, or the two corners of a box; the others have the
// spheres and the triangles of contacts. `totals` says how many entries each pose has, also where a limit lists fewer.
struct Answers {
  Runs lists[3];
  std::vector<std::size_t> totals;
};

Answers ask(const LoadedAsset& asset, const SkinPoses& poses, const Asked& asked, std::size_t threads);

// Points on the skin: a source triangle and the weights of its corners.
struct SkinPoints {
  const std::uint32_t* triangles;
  const float* weights;  // three a point
  std::size_t count;
};

// Where the points are in each pose: x, y, z. Throws where a triangle is not in the asset's skin.
template <typename T>
void place_points(const LoadedAsset& asset, const Poses<T>& poses, const float* morph_weights, const SkinPoints& points,
                  std::size_t threads, T* out);

// A penetration's distance is direction . (deepest_other - deepest); without a previous frame it is the depth. Its
// gradient by the matrices, with the two points fixed on the skin, times the penetration's slope, added up in the pose
// that it belongs to: 12 numbers a bone.
void add_depth_gradients(const LoadedAsset& asset, const Penetration* penetrations, const float* slopes,
                         const std::size_t* first, std::size_t pose_count, const float* morph_weights, float* gradient);

}  // namespace spherechain::python
