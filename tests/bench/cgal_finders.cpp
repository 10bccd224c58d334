// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's self-intersection of boxes.
#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/box_intersection_d.h>

#include "pair_finder.h"

namespace spherechain::bench {
namespace {

using TriangleBox = CGAL::Box_intersection_d::Box_with_info_d<float, 3, std::uint32_t>;

class CgalFinder : public PairFinder {
 public:
  explicit CgalFinder(const Asset& asset)
      : PairFinder("CGAL box_self_intersection_d", Found::kBoxes),
        list_(asset),
        boxes_(view_of(asset).spheres().size) {}

  void find(const Sphere* spheres) override {
    for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
      const Sphere& s = spheres[i];
      float low[] = {s.x - s.radius, s.y - s.radius, s.z - s.radius};
      float high[] = {s.x + s.radius, s.y + s.radius, s.z + s.radius};
      boxes_[i] = TriangleBox(low, high, i);
    }
    list_.clear();
    CGAL::box_self_intersection_d(boxes_.begin(), boxes_.end(), [this](const TriangleBox& l, const TriangleBox& r) {
      if (!list_.is_ignored(l.info(), r.info())) {
        list_.add(l.info(), r.info());
      }
    });
  }

  std::vector<Pair> pairs() const override { return list_.pairs(); }

 private:
  PairList list_;
  std::vector<TriangleBox> boxes_;
};

}  // namespace

PairFinders cgal_finders(const Asset& asset) {
  PairFinders out;
  out.push_back(std::make_unique<CgalFinder>(asset));
  return out;
}

}  // namespace spherechain::bench
