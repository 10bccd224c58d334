// SPDX-License-Identifier: GPL-3.0-or-later
// ODE's spaces of boxes: the hash, and sweep and prune.
#include <ode/ode.h>

#include "pair_finder.h"

namespace spherechain::bench {
namespace {

class OdeFinder : public PairFinder {
 public:
  OdeFinder(const Asset& asset, std::string name, dSpaceID space)
      : PairFinder(std::move(name), Found::kBoxes), list_(asset), space_(space) {
    for (std::size_t i = 0; i < view_of(asset).spheres().size; ++i) {
      geoms_.push_back(dCreateSphere(space_, 1));
      dGeomSetData(geoms_.back(), reinterpret_cast<void*>(i));
    }
  }
  ~OdeFinder() override { dSpaceDestroy(space_); }

  void find(const Sphere* spheres) override {
    for (std::size_t i = 0; i < geoms_.size(); ++i) {
      dGeomSphereSetRadius(geoms_[i], spheres[i].radius);
      dGeomSetPosition(geoms_[i], spheres[i].x, spheres[i].y, spheres[i].z);
    }
    list_.clear();
    dSpaceCollide(space_, &list_, &OdeFinder::on_pair);
  }

  std::vector<Pair> pairs() const override { return list_.pairs(); }

 private:
  static void on_pair(void* list_pointer, dGeomID l, dGeomID r) {
    PairList& list = *static_cast<PairList*>(list_pointer);
    const auto a = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(dGeomGetData(l)));
    const auto b = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(dGeomGetData(r)));
    if (!list.is_ignored(a, b)) {
      list.add(a, b);
    }
  }

  PairList list_;
  dSpaceID space_;
  std::vector<dGeomID> geoms_;
};

// ODE has one initialisation a process.
struct Ode {
  Ode() { dInitODE2(0); }
  ~Ode() { dCloseODE(); }
};

}  // namespace

PairFinders ode_finders(const Asset& asset) {
  static const Ode ode;
  PairFinders out;
  out.push_back(std::make_unique<OdeFinder>(asset, "ODE hash space", dHashSpaceCreate(nullptr)));
  out.push_back(
      std::make_unique<OdeFinder>(asset, "ODE sweep and prune", dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ)));
  return out;
}

}  // namespace spherechain::bench
