// SPDX-License-Identifier: GPL-3.0-or-later
#include "segment/curve_skeleton.h"

#include "segment/skeleton_arena.h"

// CGAL collapses edges in the order of their addresses. Out of the arena addresses follow the order of creation, so
// that a mesh has one skeleton, not one a process. CGAL's containers ask this macro for their allocator; it must come
// before them and stay in this file.
#define CGAL_ALLOCATOR(T) spherechain::baker::ArenaAllocator<T>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_ratio_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Edge_length_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Midpoint_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <CGAL/extract_mean_curvature_flow_skeleton.h>

#include "mesh/canonical_mesh.h"

namespace spherechain::baker {
namespace {

// A skeleton's branches are the same of fewer triangles, and its time grows faster than their number.
constexpr std::size_t kEnoughTriangles = 40'000;

}  // namespace

CurveSkeleton extract_curve_skeleton(const Mesh& original) {
  using Kernel = CGAL::Simple_cartesian<double>;
  using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
  using Skeletonization = CGAL::Mean_curvature_flow_skeletonization<SurfaceMesh>;

  const CanonicalMesh canonical = make_canonical(original);
  const Mesh& mesh = canonical.mesh;
  SurfaceMesh surface;
  std::vector<SurfaceMesh::Vertex_index> vertices;
  for (const Vec3& p : mesh.positions) vertices.push_back(surface.add_vertex({p.x(), p.y(), p.z()}));
  for (const Triangle& t : mesh.triangles) surface.add_face(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
  if (mesh.triangles.size() > kEnoughTriangles) {
    namespace simplification = CGAL::Surface_mesh_simplification;
    const double kept = static_cast<double>(kEnoughTriangles) / static_cast<double>(mesh.triangles.size());
    const simplification::Count_ratio_stop_predicate<SurfaceMesh> stop(kept);
    simplification::edge_collapse(surface, stop,
                                  CGAL::parameters::get_cost(simplification::Edge_length_cost<SurfaceMesh>())
                                      .get_placement(simplification::Midpoint_placement<SurfaceMesh>()));
    surface.collect_garbage();
  }

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
