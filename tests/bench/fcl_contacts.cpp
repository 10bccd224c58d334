// SPDX-License-Identifier: GPL-3.0-or-later
// FCL's tree of oriented boxes over the mesh, refitted to the pose, then collided with itself. In double precision, and
// its triangle test is not exact.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <limits>

#include "contact_finder.h"

namespace spherechain::bench {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

class FclContacts : public ContactFinder {
 public:
  explicit FclContacts(const ContactMesh& mesh)
      : ContactFinder("FCL BVHModel refit + collide"), mesh_(mesh), model_(std::make_shared<Model>()) {
    std::vector<fcl::Vector3d> points(mesh.vertices.size());
    const auto& rest = mesh.character.bake.character.source_positions;
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] = rest[mesh.vertices[i]];
    }
    std::vector<fcl::Triangle> triangles;
    for (std::size_t t = 0; t < mesh.source_triangles.size(); ++t) {
      triangles.emplace_back(mesh.welds[3 * t], mesh.welds[3 * t + 1], mesh.welds[3 * t + 2]);
    }
    model_->beginModel(static_cast<int>(triangles.size()), static_cast<int>(points.size()));
    model_->addSubModel(points, triangles);
    model_->endModel();
    moved_ = points;
    request_.num_max_contacts = std::numeric_limits<std::size_t>::max();
  }

  void find(const ContactPose& pose) override {
    for (std::size_t i = 0; i < moved_.size(); ++i) {
      const float* p = pose.positions.data() + 3 * std::size_t{mesh_.vertices[i]};
      moved_[i] = {p[0], p[1], p[2]};
    }
    model_->beginUpdateModel();
    model_->updateSubModel(moved_);
    model_->endUpdateModel(true, true);
    result_.clear();
    const fcl::Transform3d none = fcl::Transform3d::Identity();
    fcl::collide<double>(model_.get(), none, model_.get(), none, request_, result_);
  }

  std::vector<Pair> pairs() override {
    std::vector<Pair> out;
    for (std::size_t i = 0; i < result_.numContacts(); ++i) {
      const auto a = static_cast<std::uint32_t>(result_.getContact(i).b1);
      const auto b = static_cast<std::uint32_t>(result_.getContact(i).b2);
      if (a < b && mesh_.is_wanted(a, b)) {
        const std::uint32_t s = mesh_.source_triangles[a], t = mesh_.source_triangles[b];
        out.push_back({std::min(s, t), std::max(s, t)});
      }
    }
    return out;
  }

 private:
  const ContactMesh& mesh_;
  std::shared_ptr<Model> model_;
  std::vector<fcl::Vector3d> moved_;
  fcl::CollisionRequestd request_;
  fcl::CollisionResultd result_;
};

}  // namespace

ContactFinders fcl_contact_finders(const ContactMesh& mesh) {
  ContactFinders out;
  out.push_back(std::make_unique<FclContacts>(mesh));
  return out;
}

}  // namespace spherechain::bench
