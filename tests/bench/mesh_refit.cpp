// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_refit.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cstring>

namespace spherechain::bench {

struct MeshRefit::Scene {
  const std::vector<std::vector<float>>& meshes;
  RTCDevice device = rtcNewDevice("threads=1");
  RTCScene scene = rtcNewScene(device);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  float* vertices = nullptr;  // Embree's; a buffer exchanged for another would make it build anew
};

MeshRefit::MeshRefit(const PosedCharacter& character, const std::vector<std::vector<float>>& meshes)
    : scene_(std::make_unique<Scene>(Scene{meshes})) {
  const auto& triangles = character.bake.character.source_triangles;
  rtcSetSceneFlags(scene_->scene, RTC_SCENE_FLAG_DYNAMIC);
  rtcSetSceneBuildQuality(scene_->scene, RTC_BUILD_QUALITY_LOW);  // of two levels: else it builds the mesh anew
  rtcSetGeometryBuildQuality(scene_->geometry, RTC_BUILD_QUALITY_REFIT);
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      scene_->geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), triangles.size()));
  for (const auto& triangle : triangles) {
    for (const auto corner : triangle) {
      *indices++ = static_cast<unsigned>(corner);
    }
  }
  scene_->vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      scene_->geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), meshes[0].size() / 3));
  rtcAttachGeometry(scene_->scene, scene_->geometry);
  refit(0);  // the first builds
}

MeshRefit::~MeshRefit() {
  rtcReleaseGeometry(scene_->geometry);
  rtcReleaseScene(scene_->scene);
  rtcReleaseDevice(scene_->device);
}

void MeshRefit::refit(std::size_t mesh) {
  const std::vector<float>& vertices = scene_->meshes[mesh];
  std::memcpy(scene_->vertices, vertices.data(), vertices.size() * sizeof(float));
  rtcUpdateGeometryBuffer(scene_->geometry, RTC_BUFFER_TYPE_VERTEX, 0);
  rtcCommitGeometry(scene_->geometry);
  rtcCommitScene(scene_->scene);
}

bool MeshRefit::bounds(std::size_t mesh) const {
  RTCBounds box;
  rtcGetSceneBounds(scene_->scene, &box);
  const float found[] = {box.lower_x, box.lower_y, box.lower_z, -box.upper_x, -box.upper_y, -box.upper_z};
  const std::vector<float>& vertices = scene_->meshes[mesh];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float low = vertices[axis], high = low;
    for (std::size_t i = axis; i < vertices.size(); i += 3) {
      low = std::min(low, vertices[i]);
      high = std::max(high, vertices[i]);
    }
    if (found[axis] != low || found[3 + axis] != -high) {
      return false;
    }
  }
  return true;
}

}  // namespace spherechain::bench
