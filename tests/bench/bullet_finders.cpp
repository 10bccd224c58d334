// SPDX-License-Identifier: GPL-3.0-or-later
// Bullet: its broad phase alone, which leaves out ignored pairs by its filter callback, and a world's whole discrete
// detection, whose contacts closer than 0 are the pairs.
#include <btBulletCollisionCommon.h>

#include "pair_finder.h"

namespace spherechain::bench {
namespace {

class IgnoreFilter : public btOverlapFilterCallback {
 public:
  explicit IgnoreFilter(const PairList& list) : list_(list) {}
  bool needBroadphaseCollision(btBroadphaseProxy* l, btBroadphaseProxy* r) const override {
    return !list_.is_ignored(index_of(l), index_of(r));
  }
  static std::uint32_t index_of(const btBroadphaseProxy* proxy) {
    return static_cast<std::uint32_t>(static_cast<const btCollisionObject*>(proxy->m_clientObject)->getUserIndex());
  }

 private:
  const PairList& list_;
};

class BulletFinder : public PairFinder {
 public:
  BulletFinder(const Asset& asset, bool is_full)
      : PairFinder(is_full ? "Bullet discrete detection" : "Bullet broad phase",
                   is_full ? Found::kTouching : Found::kBoxes),
        is_full_(is_full),
        list_(asset),
        filter_(list_),
        dispatcher_(&configuration_),
        world_(&dispatcher_, &broad_phase_, &configuration_),
        count_(view_of(asset).spheres().size) {
    broad_phase_.getOverlappingPairCache()->setOverlapFilterCallback(&filter_);
    for (std::size_t i = 0; i < count_; ++i) {
      shapes_.push_back(std::make_unique<btSphereShape>(view_of(asset).spheres()[i].detect_radius));
      objects_.push_back(std::make_unique<btCollisionObject>());
      objects_.back()->setCollisionShape(shapes_.back().get());
      objects_.back()->setUserIndex(static_cast<int>(i));
      world_.addCollisionObject(objects_.back().get());
    }
  }
  ~BulletFinder() override {
    for (const auto& object : objects_) {
      world_.removeCollisionObject(object.get());
    }
  }

  void find(const Sphere* spheres) override {
    list_.clear();
    for (std::size_t i = 0; i < count_; ++i) {
      shapes_[i]->setUnscaledRadius(spheres[i].radius);
      objects_[i]->getWorldTransform().setOrigin({spheres[i].x, spheres[i].y, spheres[i].z});
    }
    if (is_full_) {
      world_.performDiscreteCollisionDetection();
      list_contacts();
    } else {
      world_.updateAabbs();
      broad_phase_.calculateOverlappingPairs(&dispatcher_);
      list_boxes();
    }
  }

  std::vector<Pair> pairs() const override { return list_.pairs(); }

 private:
  void list_boxes() {
    const btBroadphasePairArray& found = broad_phase_.getOverlappingPairCache()->getOverlappingPairArray();
    for (int i = 0; i < found.size(); ++i) {
      list_.add(IgnoreFilter::index_of(found[i].m_pProxy0), IgnoreFilter::index_of(found[i].m_pProxy1));
    }
  }
  void list_contacts() {
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold* manifold = dispatcher_.getManifoldByIndexInternal(i);
      if (manifold->getNumContacts() > 0 && manifold->getContactPoint(0).getDistance() < 0) {
        list_.add(static_cast<std::uint32_t>(manifold->getBody0()->getUserIndex()),
                  static_cast<std::uint32_t>(manifold->getBody1()->getUserIndex()));
      }
    }
  }

  bool is_full_;
  PairList list_;
  IgnoreFilter filter_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broad_phase_;
  btCollisionWorld world_;
  std::size_t count_;
  std::vector<std::unique_ptr<btSphereShape>> shapes_;
  std::vector<std::unique_ptr<btCollisionObject>> objects_;
};

}  // namespace

PairFinders bullet_finders(const Asset& asset) {
  PairFinders out;
  out.push_back(std::make_unique<BulletFinder>(asset, false));
  out.push_back(std::make_unique<BulletFinder>(asset, true));
  return out;
}

}  // namespace spherechain::bench
