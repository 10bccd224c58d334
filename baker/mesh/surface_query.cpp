// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/surface_query.h"

#include <CGAL/AABB_tree.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/version.h>
#if CGAL_VERSION_MAJOR >= 6
#include <CGAL/AABB_traits_3.h>
#include <CGAL/AABB_triangle_primitive_3.h>
#else
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_triangle_primitive.h>
#endif

#include <numeric>
#include <type_traits>

namespace spherechain::baker {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
#if CGAL_VERSION_MAJOR >= 6
using Primitive = CGAL::AABB_triangle_primitive_3<Kernel, Triangles::const_iterator>;
using TraitsOfCgal = CGAL::AABB_traits_3<Kernel, Primitive>;
#else
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using TraitsOfCgal = CGAL::AABB_traits<Kernel, Primitive>;
#endif

Kernel::Point_3 to_cgal(const Vec3& p) { return {p.x(), p.y(), p.z()}; }
Vec3 from_cgal(const Kernel::Point_3& p) { return {p.x(), p.y(), p.z()}; }

// CGAL's ray against a triangle ends the program where rounding makes a flat triangle contradict itself. This one has
// no such case: a triangle that the ray lies in, or that has no area, is not hit.
struct Traits : TraitsOfCgal {
  struct Intersection {
    using Hit = Intersection_and_primitive_id<Kernel::Ray_3>::Type;
    // An optional of Boost before CGAL 6, of the standard library since.
    using Result = std::invoke_result_t<TraitsOfCgal::Intersection, const Kernel::Ray_3&, const Primitive&>;
    Result operator()(const Kernel::Ray_3& ray, const Primitive& primitive) const {
      const Kernel::Triangle_3& triangle = *primitive.id();
      const Kernel::Vector_3 direction = ray.to_vector();
      const Kernel::Vector_3 a = triangle[0] - ray.source(), b = triangle[1] - ray.source(),
                             c = triangle[2] - ray.source();
      const auto side = [&](const Kernel::Vector_3& from, const Kernel::Vector_3& to) {
        return CGAL::scalar_product(direction, CGAL::cross_product(from, to));
      };
      const double u = side(b, c), v = side(c, a), w = side(a, b), sum = u + v + w;
      const bool is_inside = (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
      if (!is_inside || sum == 0) return {};
      const Kernel::Vector_3 offset = (u * a + v * b + w * c) / sum;
      if (CGAL::scalar_product(offset, direction) < 0) return {};
      return Hit(ray.source() + offset, primitive.id());
    }
  };
  Intersection intersection_object() const { return {}; }
};
using AabbTree = CGAL::AABB_tree<Traits>;

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
  const Vec3 p = from_cgal(get<Kernel::Point_3>(hit->first));
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
