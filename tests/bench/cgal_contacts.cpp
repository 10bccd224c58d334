// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's exact self-intersections of a triangle soup: boxes sorted, then exact predicates. On one thread.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include "contact_finder.h"

namespace spherechain::bench {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Face = SurfaceMesh::Face_index;

class CgalContacts : public ContactFinder {
 public:
  explicit CgalContacts(const ContactMesh& mesh) : ContactFinder("CGAL self_intersections"), mesh_(mesh) {
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      surface_.add_vertex(Kernel::Point_3());
    }
    triangle_of_ = surface_.add_property_map<Face, std::uint32_t>("f:triangle", 0).first;
    using Vertex = SurfaceMesh::Vertex_index;
    for (std::uint32_t t = 0; t < mesh.source_triangles.size(); ++t) {
      const Face face =
          surface_.add_face(Vertex(mesh.welds[3 * t]), Vertex(mesh.welds[3 * t + 1]), Vertex(mesh.welds[3 * t + 2]));
      if (face == SurfaceMesh::null_face()) {
        throw std::runtime_error("CGAL: the surface is no mesh");
      }
      triangle_of_[face] = t;
    }
  }

  void find(const ContactPose& pose) override {
    for (const auto vertex : surface_.vertices()) {
      const float* p = pose.positions.data() + 3 * std::size_t{mesh_.vertices[vertex]};
      surface_.point(vertex) = {p[0], p[1], p[2]};
    }
    found_.clear();
    CGAL::Polygon_mesh_processing::self_intersections<CGAL::Sequential_tag>(surface_, std::back_inserter(found_));
  }

  std::vector<Pair> pairs() override {
    std::vector<Pair> out;
    for (const auto& [f, g] : found_) {
      const std::uint32_t a = triangle_of_[f], b = triangle_of_[g];
      if (mesh_.is_wanted(a, b)) {
        const std::uint32_t p = mesh_.source_triangles[a], q = mesh_.source_triangles[b];
        out.push_back({std::min(p, q), std::max(p, q)});
      }
    }
    return out;
  }

 private:
  const ContactMesh& mesh_;
  SurfaceMesh surface_;
  SurfaceMesh::Property_map<Face, std::uint32_t> triangle_of_;
  std::vector<std::pair<Face, Face>> found_;
};

}  // namespace

ContactFinders cgal_contact_finders(const ContactMesh& mesh) {
  ContactFinders out;
  out.push_back(std::make_unique<CgalContacts>(mesh));
  return out;
}

}  // namespace spherechain::bench
