// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/curve_skeleton.h"

#include "baker/segment/skeleton_arena.h"

// CGAL collapses edges in the order of their addresses. Out of the arena addresses follow the order of creation, so
// that a mesh has one skeleton, not one a process. CGAL's containers ask this macro for their allocator; it must come
// before them and stay in this file.
#define CGAL_ALLOCATOR(T) spherechain::baker::ArenaAllocator<T>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/Euler_operations.h>
#include <CGAL/extract_mean_curvature_flow_skeleton.h>

#include <cmath>

#include "baker/mesh/canonical_mesh.h"

namespace spherechain::baker {
namespace {

// A skeleton's branches are the same of fewer triangles, and its time grows faster than their number.
constexpr std::size_t kManyTriangles = 40'000, kEnoughTriangles = 20'000;
constexpr double kLonger = 1.1;  // the length of edges that collapse in a round, over that of the round before

using Kernel = CGAL::Simple_cartesian<double>;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

// Collapses short edges to their midpoints, in rounds, until few enough triangles are left or none can. In a round
// a vertex moves once. This is faster than CGAL's simplification, which keeps all edges sorted.
void simplify(SurfaceMesh& surface, double span) {
  const auto squared_length = [&](SurfaceMesh::Edge_index e) {
    return CGAL::squared_distance(surface.point(surface.vertex(e, 0)), surface.point(surface.vertex(e, 1)));
  };
  const auto are_few = [&] { return surface.number_of_faces() <= kEnoughTriangles; };
  double sum = 0;
  for (const auto e : surface.edges()) sum += std::sqrt(squared_length(e));
  for (double limit = sum / surface.number_of_edges(); limit < span && !are_few(); limit *= kLonger) {
    std::vector<bool> moved(surface.num_vertices());
    for (const auto e : surface.edges()) {
      if (are_few()) break;
      const auto a = surface.vertex(e, 0), b = surface.vertex(e, 1);
      if (moved[a] || moved[b] || squared_length(e) > limit * limit ||
          !CGAL::Euler::does_satisfy_link_condition(e, surface)) {
        continue;
      }
      const Kernel::Point_3 middle = CGAL::midpoint(surface.point(a), surface.point(b));
      const auto kept = CGAL::Euler::collapse_edge(e, surface);
      surface.point(kept) = middle;
      moved[kept] = true;
    }
  }
  surface.collect_garbage();
}

}  // namespace

CurveSkeleton extract_curve_skeleton(const Mesh& original) {
  using Skeletonization = CGAL::Mean_curvature_flow_skeletonization<SurfaceMesh>;

  const CanonicalMesh canonical = make_canonical(original);
  const Mesh& mesh = canonical.mesh;
  SurfaceMesh surface;
  std::vector<SurfaceMesh::Vertex_index> vertices;
  for (const Vec3& p : mesh.positions) vertices.push_back(surface.add_vertex({p.x(), p.y(), p.z()}));
  for (const Triangle& t : mesh.triangles) surface.add_face(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
  if (mesh.triangles.size() > kManyTriangles) simplify(surface, diameter(mesh));

  const SkeletonArena arena(surface.number_of_faces());
  Skeletonization skeletonization(surface);
  // CGAL's default is this fraction of an axis-aligned diagonal, which turns with the mesh.
  skeletonization.set_min_edge_length(0.002 * diameter(mesh));
  Skeletonization::Skeleton graph;
  skeletonization(graph);

  CurveSkeleton skeleton;
  skeleton.points.resize(boost::num_vertices(graph));
  skeleton.neighbours.resize(skeleton.points.size());
  for (const auto v : CGAL::make_range(boost::vertices(graph))) {
    const Kernel::Point_3& p = graph[v].point;
    skeleton.points[v] = canonical.to_original(Vec3(p.x(), p.y(), p.z()));
  }
  for (const auto e : CGAL::make_range(boost::edges(graph))) {
    const auto a = boost::source(e, graph), b = boost::target(e, graph);
    skeleton.neighbours[a].push_back(static_cast<Index>(b));
    skeleton.neighbours[b].push_back(static_cast<Index>(a));
  }
  return skeleton;
}

}  // namespace spherechain::baker
