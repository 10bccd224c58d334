// SPDX-License-Identifier: GPL-3.0-or-later
// FCL's dynamic tree of boxes, refitted each pose: by itself, and with FCL's own test of the spheres whose boxes touch.
// In double precision, for which Debian has the library compiled.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>

#include "pair_finder.h"

namespace spherechain::bench {
namespace {

class FclFinder : public PairFinder {
 public:
  FclFinder(const Asset& asset, bool tests_spheres)
      : PairFinder(tests_spheres ? "FCL tree + sphere test" : "FCL tree",
                   tests_spheres ? Found::kTouching : Found::kBoxes),
        tests_spheres_(tests_spheres),
        list_(asset) {
    for (std::size_t i = 0; i < view_of(asset).spheres().size; ++i) {
      shapes_.push_back(std::make_shared<fcl::Sphered>(view_of(asset).spheres()[i].detect_radius));
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(shapes_.back()));
      objects_.back()->setUserData(reinterpret_cast<void*>(i));
      tree_.registerObject(objects_.back().get());
    }
    tree_.setup();
  }

  void find(const Sphere* spheres) override {
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      const Sphere& s = spheres[i];
      shapes_[i]->radius = s.radius;
      shapes_[i]->aabb_local = {fcl::Vector3d::Constant(-s.radius), fcl::Vector3d::Constant(s.radius)};
      shapes_[i]->aabb_center.setZero();
      shapes_[i]->aabb_radius = s.radius;
      objects_[i]->setTranslation(fcl::Vector3d(s.x, s.y, s.z));
      objects_[i]->computeAABB();
    }
    tree_.update();
    list_.clear();
    tree_.collide(this, &FclFinder::on_pair);
  }

  std::vector<Pair> pairs() const override { return list_.pairs(); }

 private:
  static bool on_pair(fcl::CollisionObjectd* l, fcl::CollisionObjectd* r, void* self_pointer) {
    auto& self = *static_cast<FclFinder*>(self_pointer);
    const auto a = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(l->getUserData()));
    const auto b = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(r->getUserData()));
    if (self.list_.is_ignored(a, b)) {
      return false;
    }
    if (self.tests_spheres_) {
      self.result_.clear();
      if (fcl::collide(l, r, self.request_, self.result_) == 0) {
        return false;
      }
    }
    self.list_.add(a, b);
    return false;  // go on
  }

  bool tests_spheres_;
  PairList list_;
  std::vector<std::shared_ptr<fcl::Sphered>> shapes_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  fcl::DynamicAABBTreeCollisionManagerd tree_;
  fcl::CollisionRequestd request_;
  fcl::CollisionResultd result_;
};

}  // namespace

PairFinders fcl_finders(const Asset& asset) {
  PairFinders out;
  out.push_back(std::make_unique<FclFinder>(asset, false));
  out.push_back(std::make_unique<FclFinder>(asset, true));
  return out;
}

}  // namespace spherechain::bench
