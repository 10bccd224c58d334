// SPDX-License-Identifier: GPL-3.0-or-later
// Embree: a tree of the spheres' boxes built anew (commit), then collided with itself. On one thread.
#include <embree3/rtcore.h>

#include "pair_finder.h"

namespace spherechain::bench {
namespace {

class EmbreeFinder : public PairFinder {
 public:
  explicit EmbreeFinder(const Asset& asset)
      : PairFinder("Embree commit + collide", Found::kBoxes),
        list_(asset),
        device_(rtcNewDevice("threads=1")),
        scene_(rtcNewScene(device_)),
        geometry_(rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
    rtcSetGeometryUserPrimitiveCount(geometry_, static_cast<unsigned>(view_of(asset).spheres().size));
    rtcSetGeometryUserData(geometry_, this);
    rtcSetGeometryBoundsFunction(geometry_, &EmbreeFinder::bounds, nullptr);
    rtcAttachGeometry(scene_, geometry_);
  }
  ~EmbreeFinder() override {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  void find(const Sphere* spheres) override {
    spheres_ = spheres;
    list_.clear();
    rtcCommitGeometry(geometry_);
    rtcCommitScene(scene_);
    rtcCollide(scene_, scene_, &EmbreeFinder::on_pairs, this);
  }

  std::vector<Pair> pairs() const override { return list_.pairs(); }

 private:
  static void bounds(const RTCBoundsFunctionArguments* arguments) {
    const Sphere& s = static_cast<const EmbreeFinder*>(arguments->geometryUserPtr)->spheres_[arguments->primID];
    RTCBounds& out = *arguments->bounds_o;
    out.lower_x = s.x - s.radius;
    out.lower_y = s.y - s.radius;
    out.lower_z = s.z - s.radius;
    out.upper_x = s.x + s.radius;
    out.upper_y = s.y + s.radius;
    out.upper_z = s.z + s.radius;
  }
  // Each pair comes both ways, and each sphere with itself.
  static void on_pairs(void* self_pointer, RTCCollision* found, unsigned count) {
    PairList& list = static_cast<EmbreeFinder*>(self_pointer)->list_;
    for (unsigned i = 0; i < count; ++i) {
      if (found[i].primID0 < found[i].primID1 && !list.is_ignored(found[i].primID0, found[i].primID1)) {
        list.add(found[i].primID0, found[i].primID1);
      }
    }
  }

  const Sphere* spheres_ = nullptr;
  PairList list_;
  RTCDevice device_;
  RTCScene scene_;
  RTCGeometry geometry_;
};

}  // namespace

PairFinders embree_finders(const Asset& asset) {
  PairFinders out;
  out.push_back(std::make_unique<EmbreeFinder>(asset));
  return out;
}

}  // namespace spherechain::bench
