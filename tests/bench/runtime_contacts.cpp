// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdexcept>

#include "contact_finder.h"
#include "spherechain/triangle_contacts.h"

namespace spherechain::bench {
namespace {

class RuntimeFinder : public ContactFinder {
 public:
  RuntimeFinder(const Asset& asset, const std::string& source, bool reads_vertices, bool reads_bones)
      : ContactFinder("spherechain from " + source),
        reads_vertices_(reads_vertices),
        reads_bones_(reads_bones),
        words_(TriangleContactContext::words_needed(asset)),
        pairs_(1 << 16) {
    context_.words = {words_.data(), words_.size()};
    job_.asset = &asset;
    job_.context = &context_;
    job_.pairs = {pairs_.data(), pairs_.size()};
  }

  void find(const ContactPose& pose) override {
    if (reads_bones_) {
      job_.bones = pose.bones;
    }
    if (reads_vertices_) {
      job_.positions = pose.positions.data();
      job_.vertex_count = pose.positions.size() / 3;
    }
    const Status status = job_.run();
    if (status != Status::kOk) {
      throw std::runtime_error(name + ": " + to_string(status));
    }
  }

  std::vector<TrianglePair> pairs() const override {
    return {pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(job_.pair_count)};
  }

 private:
  bool reads_vertices_, reads_bones_;
  std::vector<std::uint64_t> words_;
  TriangleContactContext context_;
  TriangleContactJob job_;
  std::vector<TrianglePair> pairs_;
};

}  // namespace

ContactFinders runtime_contact_finders(const ContactMesh& mesh) {
  ContactFinders out;
  const Asset& asset = mesh.character.asset;
  out.push_back(std::make_unique<RuntimeFinder>(asset, "vertices", true, false));
  out.push_back(std::make_unique<RuntimeFinder>(asset, "bones", false, true));
  out.push_back(std::make_unique<RuntimeFinder>(asset, "both", true, true));
  return out;
}

}  // namespace spherechain::bench
