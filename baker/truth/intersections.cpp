// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/truth/intersections.h"

#include <CGAL/Bbox_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>

namespace spherechain::baker {
namespace {

using TriangleBox = CGAL::Box_intersection_d::Box_with_info_d<double, 3, Index>;

template <typename Kernel>
typename Kernel::Triangle_3 triangle_at(const TruthSurface& surface, const std::vector<float>& positions, Index place) {
  const auto corner = [&](std::size_t k) {
    const float* p = &positions[std::size_t{3} * surface.corners[place][k]];
    return typename Kernel::Point_3(p[0], p[1], p[2]);
  };
  return {corner(0), corner(1), corner(2)};
}

// Smaller than a millionth (2^-20) of its greatest coordinate: noise of blended weights, no triangle.
template <typename Triangle>
bool is_point(const Triangle& t) {
  const CGAL::Bbox_3 box = t.bbox();
  double most = 0, extent = 0;
  for (int k = 0; k < 3; ++k) {
    most = std::max({most, -box.min(k), box.max(k)});
    extent = std::max(extent, box.max(k) - box.min(k));
  }
  return extent <= 0x1p-20 * most;
}

// Triangles without area, and points, have no box: they intersect nothing.
struct ExactTriangles {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Kernel::Triangle_3> triangles;
  std::vector<TriangleBox> boxes;

  ExactTriangles(const TruthSurface& surface, const std::vector<float>& positions) {
    triangles.reserve(surface.corners.size());
    boxes.reserve(surface.corners.size());
    for (Index i = 0; i < surface.corners.size(); ++i) {
      triangles.push_back(triangle_at<Kernel>(surface, positions, i));
      if (!triangles[i].is_degenerate() && !is_point(triangles[i])) boxes.emplace_back(triangles[i].bbox(), i);
    }
  }
};

}  // namespace

Intersections find_intersections(const TruthSurface& surface, const std::vector<float>& positions) {
  Intersections out;
  ExactTriangles body(surface, positions);
  out.degenerate = surface.corners.size() - body.boxes.size();
  const auto meet = [&](const TriangleBox& l, const TriangleBox& r) {
    const Index a = std::min(l.info(), r.info()), b = std::max(l.info(), r.info());
    if (are_neighbours(surface.welded[a], surface.welded[b])) return;
    if (!CGAL::do_intersect(body.triangles[a], body.triangles[b])) return;
    out.pairs.push_back({surface.source_triangle[a], surface.source_triangle[b]});
  };
  CGAL::box_self_intersection_d(body.boxes.begin(), body.boxes.end(), meet);
  std::sort(out.pairs.begin(), out.pairs.end());
  return out;
}

std::vector<Pair> find_intersections(const TruthSurface& a, const std::vector<float>& positions_a,
                                     const TruthSurface& b, const std::vector<float>& positions_b) {
  std::vector<Pair> out;
  ExactTriangles of_a(a, positions_a), of_b(b, positions_b);
  CGAL::box_intersection_d(of_a.boxes.begin(), of_a.boxes.end(), of_b.boxes.begin(), of_b.boxes.end(),
                           [&](const TriangleBox& l, const TriangleBox& r) {
                             if (CGAL::do_intersect(of_a.triangles[l.info()], of_b.triangles[r.info()])) {
                               out.push_back({a.source_triangle[l.info()], b.source_triangle[r.info()]});
                             }
                           });
  std::sort(out.begin(), out.end());
  return out;
}

std::set<Pair> close_owners(const TruthSurface& surface, const std::vector<float>& positions,
                            const std::vector<std::uint32_t>& owner, double distance) {
  using Kernel = CGAL::Simple_cartesian<double>;
  std::vector<Kernel::Triangle_3> triangles;
  std::vector<TriangleBox> boxes;
  for (Index i = 0; i < surface.corners.size(); ++i) {
    triangles.push_back(triangle_at<Kernel>(surface, positions, i));
    const CGAL::Bbox_3 box = triangles[i].bbox();
    const double margin = distance / 2;
    boxes.emplace_back(CGAL::Bbox_3(box.xmin() - margin, box.ymin() - margin, box.zmin() - margin, box.xmax() + margin,
                                    box.ymax() + margin, box.zmax() + margin),
                       i);
  }
  std::set<Pair> out;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const TriangleBox& l, const TriangleBox& r) {
    const auto [a, b] = std::minmax(owner[l.info()], owner[r.info()]);
    if (a == b || out.count({a, b}) > 0) return;
    if (CGAL::squared_distance(triangles[l.info()], triangles[r.info()]) < distance * distance) out.insert({a, b});
  });
  return out;
}

bool any_closer(const TruthSurface& surface, const std::vector<float>& positions, const std::vector<Index>& one,
                const std::vector<Index>& other, double distance) {
  using Kernel = CGAL::Simple_cartesian<double>;
  const auto boxed = [&](const std::vector<Index>& places) {
    std::vector<std::pair<CGAL::Bbox_3, Index>> out;
    for (const Index place : places) out.emplace_back(triangle_at<Kernel>(surface, positions, place).bbox(), place);
    return out;
  };
  const auto apart = [&](const CGAL::Bbox_3& l, const CGAL::Bbox_3& r) {
    for (int k = 0; k < 3; ++k) {
      if (l.min(k) - r.max(k) >= distance || r.min(k) - l.max(k) >= distance) return true;
    }
    return false;
  };
  // Each list trimmed by the other's box.
  std::vector<std::pair<CGAL::Bbox_3, Index>> left = boxed(one), right = boxed(other);
  for (int round = 0; round < 2; ++round) {
    CGAL::Bbox_3 whole;
    for (const auto& [box, place] : right) whole += box;
    std::erase_if(left, [&](const auto& entry) { return apart(entry.first, whole); });
    std::swap(left, right);
    if (left.empty() || right.empty()) return false;
  }
  for (const auto& [left_box, a] : left) {
    const Kernel::Triangle_3 triangle = triangle_at<Kernel>(surface, positions, a);
    for (const auto& [right_box, b] : right) {
      if (!apart(left_box, right_box) &&
          CGAL::squared_distance(triangle, triangle_at<Kernel>(surface, positions, b)) < distance * distance) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace spherechain::baker
