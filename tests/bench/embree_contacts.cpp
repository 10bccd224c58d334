// SPDX-License-Identifier: GPL-3.0-or-later
// Embree: its tree of the triangles' boxes refitted to the pose, then collided with itself. Embree has no triangle
// test: the runtime's own tests the triangles of boxes that touch. On one thread.
#include <embree3/rtcore.h>

#include <algorithm>

#include "contact_finder.h"
#include "runtime/src/triangles/exact_triangles.h"

namespace spherechain::bench {
namespace {

class EmbreeContacts : public ContactFinder {
 public:
  explicit EmbreeContacts(const ContactMesh& mesh)
      : ContactFinder("Embree refit + collide + triangle test"),
        mesh_(mesh),
        device_(rtcNewDevice("threads=1")),
        scene_(rtcNewScene(device_)),
        geometry_(rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetGeometryBuildQuality(geometry_, RTC_BUILD_QUALITY_REFIT);
    rtcSetGeometryUserPrimitiveCount(geometry_, static_cast<unsigned>(mesh.source_triangles.size()));
    rtcSetGeometryUserData(geometry_, this);
    rtcSetGeometryBoundsFunction(geometry_, &EmbreeContacts::bounds, nullptr);
    rtcAttachGeometry(scene_, geometry_);
    found_.reserve(1 << 16);
  }
  ~EmbreeContacts() override {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  void find(const ContactPose& pose) override {
    pose_ = &pose;
    found_.clear();
    rtcCommitGeometry(geometry_);
    rtcCommitScene(scene_);
    rtcCollide(scene_, scene_, &EmbreeContacts::on_pairs, this);
  }

  std::vector<Pair> pairs() override { return found_; }

 private:
  static void bounds(const RTCBoundsFunctionArguments* arguments) {
    const auto& self = *static_cast<const EmbreeContacts*>(arguments->geometryUserPtr);
    const float *a = self.mesh_.corner(*self.pose_, arguments->primID, 0),
                *b = self.mesh_.corner(*self.pose_, arguments->primID, 1),
                *c = self.mesh_.corner(*self.pose_, arguments->primID, 2);
    RTCBounds& out = *arguments->bounds_o;
    out.lower_x = std::min(std::min(a[0], b[0]), c[0]);
    out.lower_y = std::min(std::min(a[1], b[1]), c[1]);
    out.lower_z = std::min(std::min(a[2], b[2]), c[2]);
    out.upper_x = std::max(std::max(a[0], b[0]), c[0]);
    out.upper_y = std::max(std::max(a[1], b[1]), c[1]);
    out.upper_z = std::max(std::max(a[2], b[2]), c[2]);
  }

  // Each pair comes both ways, and each triangle with itself.
  static void on_pairs(void* self_pointer, RTCCollision* found, unsigned count) {
    auto& self = *static_cast<EmbreeContacts*>(self_pointer);
    for (unsigned i = 0; i < count; ++i) {
      const std::uint32_t a = found[i].primID0, b = found[i].primID1;
      if (a >= b || !self.mesh_.is_wanted(a, b)) {
        continue;
      }
      if (triangles_intersect(self.corners(a), self.corners(b))) {
        const std::uint32_t s = self.mesh_.source_triangles[a], t = self.mesh_.source_triangles[b];
        self.found_.push_back({std::min(s, t), std::max(s, t)});
      }
    }
  }

  TriangleCorners corners(std::uint32_t triangle) const {
    TriangleCorners out{};
    for (std::size_t k = 0; k < 3; ++k) {
      const float* p = mesh_.corner(*pose_, triangle, k);
      out.p[k] = {p[0], p[1], p[2]};
    }
    return out;
  }

  const ContactMesh& mesh_;
  const ContactPose* pose_ = nullptr;
  std::vector<Pair> found_;
  RTCDevice device_;
  RTCScene scene_;
  RTCGeometry geometry_;
};

}  // namespace

ContactFinders embree_contact_finders(const ContactMesh& mesh) {
  ContactFinders out;
  out.push_back(std::make_unique<EmbreeContacts>(mesh));
  return out;
}

}  // namespace spherechain::bench
