// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdexcept>

#include "contact_finder.h"
#include "runtime/src/inside/inside_job.h"
#include "runtime/src/pairs/detect_job.h"
#include "runtime/src/penetrations/penetration_jobs.h"
#include "runtime/src/refit/refit_job.h"
#include "runtime/src/simd/simd.h"

namespace spherechain::bench {
namespace {

enum class Output { kParts, kTriangles };

class RuntimeFinder : public ContactFinder {
 public:
  RuntimeFinder(const ContactMesh& mesh, std::string name, Output output, bool reads_vertices, bool reads_bones)
      : ContactFinder(std::move(name)),
        output_(output),
        reads_vertices_(reads_vertices),
        reads_bones_(reads_bones),
        scratch_(memory_for(skin_scratch_words(&mesh.character.asset))),
        parts_(mesh.character.view().part_count() * (mesh.character.view().part_count() + 1) / 2),
        triangles_(1 << 16) {
    job_.asset = &mesh.character.asset;
    job_.scope = SC_SCOPE_LAYERS;  // as peers, which know no layers
    job_.skin_table = mesh.skin_table.data()->words;
    job_.scratch = scratch_.data()->words;
    job_.scratch_words = skin_scratch_words(&mesh.character.asset);
    set_lists(output_ == Output::kParts, output_ == Output::kTriangles);
  }

  void find(const ContactPose& pose) override {
    job_.pose = reads_bones_ ? pose.bones : Pose{};
    if (reads_vertices_) {
      job_.pose.vertices = pose.positions.data();
      job_.pose.vertex_count = pose.positions.size() / 3;
    }
    run();
  }

  // Runs again with a list of triangles where the timed call has none.
  std::vector<Pair> pairs() override {
    if (output_ == Output::kParts) {
      std::size_t counted = 0;
      for (std::size_t i = 0; i < job_.part_count; ++i) {
        counted += parts_[i].triangle_pairs;
      }
      set_lists(false, true);
      run();
      set_lists(true, false);
      if (counted != job_.triangle_count) {
        throw std::runtime_error(name + ": the body parts' counts are not those of the triangles");
      }
    }
    std::vector<Pair> out;
    for (std::size_t i = 0; i < job_.triangle_count; ++i) {
      out.push_back({triangles_[i].triangle_a, triangles_[i].triangle_b});
    }
    return out;
  }

  const SkinContactJob& job() const { return job_; }

 private:
  void set_lists(bool has_parts, bool has_triangles) {
    job_.parts = has_parts ? parts_.data() : nullptr;
    job_.part_capacity = has_parts ? parts_.size() : 0;
    job_.triangles = has_triangles ? triangles_.data() : nullptr;
    job_.triangle_capacity = has_triangles ? triangles_.size() : 0;
  }
  void run() {
    const Status status = job_.run();
    if (status != SC_OK) {
      throw std::runtime_error(name + ": " + sc_field_name(status.field) + ": " + sc_code_text(status.code));
    }
  }

  Output output_;
  bool reads_vertices_, reads_bones_;
  Memory scratch_;
  std::vector<PartContact> parts_;
  std::vector<TriangleContact> triangles_;
  SkinContactJob job_;
};

// Contacts from bones, and how deep they are.
class DepthFinder : public ContactFinder {
 public:
  DepthFinder(const ContactMesh& mesh, const std::string& name, bool quick)
      : ContactFinder(name),
        finder_(mesh, name, Output::kTriangles, false, true),
        scratch_(memory_for(penetration_scratch_words(&mesh.character.asset, kContactsMax))),
        found_(mesh.character.view().part_count() * (mesh.character.view().part_count() + 1) / 2) {
    job_.asset = &mesh.character.asset;
    job_.scope = SC_SCOPE_LAYERS;  // as peers, which know no layers
    job_.skin_table = mesh.skin_table.data()->words;
    job_.scratch = scratch_.data()->words;
    job_.scratch_words = penetration_scratch_words(&mesh.character.asset, kContactsMax);
    job_.quick = quick ? 1 : 0;
    job_.penetrations = found_.data();
    job_.penetration_capacity = found_.size();
  }

  void find(const ContactPose& pose) override {
    finder_.find(pose);
    const SkinContactJob& found = finder_.job();
    job_.pose = found.pose;
    job_.contacts = found.triangles;
    job_.contact_count = found.triangle_count;
    if (!(job_.run() == SC_OK)) throw std::runtime_error(name + ": fails");
  }
  std::vector<Pair> pairs() override { return finder_.pairs(); }

 private:
  static constexpr std::size_t kContactsMax = 1 << 16;
  RuntimeFinder finder_;
  Memory scratch_;
  std::vector<Penetration> found_;
  PenetrationJob job_;
};

// The parts that are inside others, from bones: with the refit and the pairs of spheres, which the test begins with.
class InsideFinder : public ContactFinder {
 public:
  InsideFinder(const ContactMesh& mesh, const std::string& name)
      : ContactFinder(name),
        finder_(mesh, name, Output::kTriangles, false, true),
        spheres_(mesh.character.view().spheres().size),
        pairs_(spheres_.size() * spheres_.size() / 2),
        scratch_(memory_for(inside_scratch_words(mesh.character.view(), mesh.character.view()))),
        part_(probe_count(mesh.character.view())) {
    refit_.asset = detect_.asset = inside_.body.asset = inside_.skin.asset = &mesh.character.asset;
    refit_.spheres = spheres_.data();
    refit_.sphere_capacity = detect_.sphere_count = spheres_.size();
    detect_.spheres = spheres_.data();
    detect_.pairs = pairs_.data();
    detect_.pair_capacity = pairs_.size();
    inside_.body.skin_table = inside_.skin.skin_table = mesh.skin_table.data()->words;
    inside_.centers = {spheres_.data(), spheres_.size()};
    inside_.scratch = scratch_.data()->words;
    inside_.part = {part_.data(), part_.size()};
  }

  void find(const ContactPose& pose) override { find(pose, supported_targets()[0]); }

  // The table compares contacts, which are not asked here: these are found apart. The answer is compared with that of
  // plain arithmetic.
  std::vector<Pair> pairs() override {
    const std::vector<std::uint16_t> best = part_;
    find(*pose_, SC_TARGET_SCALAR);
    if (best != part_) throw std::runtime_error(name + ": targets disagree");
    finder_.find(*pose_);
    return finder_.pairs();
  }

 private:
  void find(const ContactPose& pose, Target target) {
    pose_ = &pose;
    refit_.target = detect_.target = inside_.target = target;
    refit_.pose = inside_.body.pose = inside_.skin.pose = pose.bones;
    if (!(refit_.run() == SC_OK && detect_.run() == SC_OK)) throw std::runtime_error(name + ": fails");
    inside_.pairs = {pairs_.data(), detect_.pair_count};
    inside_.run();
  }

  RuntimeFinder finder_;
  std::vector<Sphere> spheres_;
  std::vector<Pair> pairs_;
  Memory scratch_;
  std::vector<std::uint16_t> part_;
  RefitJob refit_;
  DetectJob detect_;
  InsideJob inside_;
  const ContactPose* pose_ = nullptr;
};

ContactFinders runtime_finders(const ContactMesh& mesh, const std::string& name, Output output) {
  ContactFinders out;
  out.push_back(std::make_unique<RuntimeFinder>(mesh, name + " from vertices", output, true, false));
  out.push_back(std::make_unique<RuntimeFinder>(mesh, name + " from bones", output, false, true));
  out.push_back(std::make_unique<RuntimeFinder>(mesh, name + " from both", output, true, true));
  return out;
}

}  // namespace

ContactFinders runtime_part_finders(const ContactMesh& mesh) {
  return runtime_finders(mesh, "spherechain", Output::kParts);
}
ContactFinders runtime_triangle_finders(const ContactMesh& mesh) {
  return runtime_finders(mesh, "spherechain triangles", Output::kTriangles);
}

ContactFinders runtime_depth_finders(const ContactMesh& mesh) {
  ContactFinders out;
  out.push_back(std::make_unique<DepthFinder>(mesh, "spherechain depth from bones", false));
  out.push_back(std::make_unique<DepthFinder>(mesh, "spherechain depth from bones, quick", true));
  out.push_back(std::make_unique<InsideFinder>(mesh, "spherechain inside from bones"));
  return out;
}

}  // namespace spherechain::bench
