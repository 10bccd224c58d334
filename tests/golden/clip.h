// SPDX-License-Identifier: MIT
// The doll and its clip, made of whole numbers, quotients and products: functions of a mathematical library are not the
// same everywhere.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "runtime/src/asset/asset_view.h"
#include "spherechain/pose.h"

namespace spherechain::test {

inline constexpr std::size_t kFrames = 300;

struct Doll {
  // Reads the folder's doll.obj and `file`, an asset baked from it. On failure `error` says why.
  Doll(const std::string& folder, const std::string& file);
  Doll(const Doll&) = delete;
  Doll& operator=(const Doll&) = delete;

  std::string error;
  std::vector<std::uint64_t> bytes;
  Asset asset;
  std::vector<float> rest;            // x, y, z of each corner of each triangle: the source's vertices
  std::vector<std::size_t> joint_of;  // the joint that moves each vertex
};

// A matrix for each joint, SC_ROWS_3X4: arms swing across and in front of the body, legs cross, the spine bends, each
// at its own pace.
std::vector<std::array<float, 12>> matrices_at(const Asset& asset, std::size_t frame);

// The same as transforms of the joints, each in its parent's space, as an engine animates them; and their parents.
std::vector<Transform> joints_at(const Asset& asset, std::size_t frame);
std::vector<std::uint32_t> parents_of(const Asset& asset);

// The mesh under those matrices, each vertex moved by one joint.
std::vector<float> positions_at(const Doll& doll, const std::vector<std::array<float, 12>>& matrices);

}  // namespace spherechain::test
