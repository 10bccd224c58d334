// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/surface_query.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <numeric>

namespace spherechain::baker {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using AabbTree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 to_cgal(const Vec3& p) { return {p.x(), p.y(), p.z()}; }
Vec3 from_cgal(const Kernel::Point_3& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace

struct SurfaceQuery::Tree {
  Triangles triangles;
  std::vector<Index> ids;
  AabbTree aabb;

  Tree(const Mesh& mesh, std::vector<Index> which) : ids(std::move(which)) {
    triangles.reserve(ids.size());
    for (const Index t : ids) {
      const Triangle& v = mesh.triangles[t];
      triangles.emplace_back(to_cgal(mesh.positions[v[0]]), to_cgal(mesh.positions[v[1]]),
                             to_cgal(mesh.positions[v[2]]));
    }
    aabb.insert(triangles.cbegin(), triangles.cend());
    aabb.build();
  }
  Index id(Triangles::const_iterator it) const { return ids[static_cast<std::size_t>(it - triangles.cbegin())]; }
};

SurfaceQuery::SurfaceQuery(const Mesh& mesh) {
  std::vector<Index> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), Index{0});
  tree_ = std::make_unique<Tree>(mesh, std::move(all));
}

SurfaceQuery::SurfaceQuery(const Mesh& mesh, const std::vector<Index>& triangles)
    : tree_(std::make_unique<Tree>(mesh, triangles)) {}

SurfaceQuery::~SurfaceQuery() = default;
SurfaceQuery::SurfaceQuery(SurfaceQuery&&) noexcept = default;
SurfaceQuery& SurfaceQuery::operator=(SurfaceQuery&&) noexcept = default;

std::optional<SurfaceHit> SurfaceQuery::first_hit(const Vec3& origin, const Vec3& direction) const {
  const Kernel::Ray_3 ray(to_cgal(origin), Kernel::Vector_3(direction.x(), direction.y(), direction.z()));
  const auto hit = tree_->aabb.first_intersection(ray);
  if (!hit) return std::nullopt;
  const auto* point = boost::get<Kernel::Point_3>(&hit->first);
  if (point == nullptr) return std::nullopt;  // the ray lies in the triangle's plane: its neighbours answer
  const Vec3 p = from_cgal(*point);
  return SurfaceHit{p, (p - origin).norm(), tree_->id(hit->second)};
}

SurfaceHit SurfaceQuery::closest(const Vec3& point) const {
  const auto [p, primitive] = tree_->aabb.closest_point_and_primitive(to_cgal(point));
  const Vec3 q = from_cgal(p);
  return {q, (q - point).norm(), tree_->id(primitive)};
}

bool SurfaceQuery::crosses(const Vec3& from, const Vec3& to) const {
  return tree_->aabb.do_intersect(Kernel::Segment_3(to_cgal(from), to_cgal(to)));
}

}  // namespace spherechain::baker
