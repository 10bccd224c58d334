// SPDX-License-Identifier: MIT
// What tests of the C API share: one asset and one pose, seen through it and through the C++ one.
#pragma once

#include <cstring>
#include <vector>

#include "jobs.h"
#include "palette.h"
#include "spherechain/spherechain.h"
#include "tiny_surface.h"

namespace spherechain::test {

struct BothApis {
  static constexpr std::size_t kSpheres = 70, kBones = 8;

  BothApis()
      : tiny(random_asset(kSpheres, 5)),
        skin(add_bones(tiny, kBones, 6)),
        opened((add_surface(tiny, &skin, 4), tiny.parts)) {
    memory.resize(sc_asset_size() / 8 + 1);
    status = sc_asset_open(SC_ABI_VERSION, memory.data(), sc_asset_size(), opened.bytes.data(), opened.bytes.size(),
                           &asset, message, sizeof message);
    spheres = refit_bones(opened.asset, rows(), {}, RadiusKind::kDetect).spheres;
    std::memcpy(c_spheres.data(), spheres.data(), sizeof c_spheres[0] * c_spheres.size());
  }

  BoneMatrices rows() const { return {matrices[0].data(), matrices.size()}; }

  // Another layout and stride of the same matrices, and morph weights, so that each field of a job counts.
  template <typename Job>
  void give_bones(const Palette& palette, Job& job) const {
    job.asset = asset;
    job.bones = {palette.memory.data(), kBones, palette.stride, static_cast<sc_matrix_layout>(palette.layout), 0};
    job.morph_weights = morph_weights.data();
    job.morph_weight_count = morph_weights.size();
  }

  template <typename Job>
  void give_spheres(Job& job) const {
    job.asset = asset;
    job.spheres = c_spheres.data();
    job.sphere_count = c_spheres.size();
  }

  TinyAsset tiny;
  TinySkin skin;
  OpenedAsset opened;
  std::vector<std::uint64_t> memory;
  const sc_asset* asset = nullptr;
  char message[160];
  sc_status status;
  std::vector<Matrix> matrices = random_matrices(kBones, 7);
  std::vector<float> morph_weights{0.25F, -0.5F, 1.0F};
  std::vector<Sphere> spheres;
  std::vector<sc_sphere> c_spheres{kSpheres};
};

template <typename C, typename Cpp>
bool same_bytes(const std::vector<C>& c, const std::vector<Cpp>& cpp) {
  return c.size() == cpp.size() && (c.empty() || std::memcmp(c.data(), cpp.data(), c.size() * sizeof(C)) == 0);
}

}  // namespace spherechain::test
