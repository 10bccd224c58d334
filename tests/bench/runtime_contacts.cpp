// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdexcept>

#include "contact_finder.h"
#include "spherechain/skin_contacts.h"

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
        scratch_(memory_for(sc_skin_scratch_words(&mesh.character.asset))),
        parts_(mesh.character.view().part_count() * (mesh.character.view().part_count() + 1) / 2),
        triangles_(1 << 16) {
    job_.asset = &mesh.character.asset;
    job_.skin_table = mesh.skin_table.data()->words;
    job_.scratch = scratch_.data()->words;
    job_.scratch_words = sc_skin_scratch_words(&mesh.character.asset);
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

}  // namespace spherechain::bench
