// SPDX-License-Identifier: MIT
// load_and_refit ASSET.sphc MODEL.glb: from deformed vertices, for engines that skin on the CPU or simulate the skin.
#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "gltf_pose.h"
#include "spherechain/spherechain.h"

using namespace spherechain;

namespace {

void check(Status status) {
  if (status != SC_OK) throw std::runtime_error(std::string(field_name(status)) + ": " + code_text(status));
}

// The asset's vertices are those of the file, buffer by buffer. Another order would give nonsense and no error, so the
// buffers are compared once, as the file has them.
void check_buffers(const Asset& asset, const samples::GltfCharacter& model) {
  const AssetInfo info = sc_asset_get_info(&asset);
  for (std::size_t i = 0; i < info.source_buffer_count; ++i) {
    const sc_source_buffer buffer = sc_asset_source_buffer(&asset, i);
    const std::vector<float>& positions = model.file_vertices(buffer.mesh, buffer.primitive);
    if (sc_check_source(&asset, i, positions.data(), positions.size() / 3, 3 * sizeof(float)) != SC_OK) {
      throw std::runtime_error("mesh " + std::to_string(buffer.mesh) + ", primitive " +
                               std::to_string(buffer.primitive) + ": not what the asset was baked from");
    }
  }
}

// The vertices of all buffers, as the asset has them.
std::vector<float> skin(const Asset& asset, const samples::GltfCharacter& model, const samples::Palette& palette) {
  const AssetInfo info = sc_asset_get_info(&asset);
  std::vector<float> vertices(3 * info.vertex_count);
  for (std::size_t i = 0; i < info.source_buffer_count; ++i) {
    const sc_source_buffer buffer = sc_asset_source_buffer(&asset, i);
    const std::vector<float> positions = model.vertices(buffer.mesh, buffer.primitive, palette);
    std::copy(positions.begin(), positions.end(), vertices.begin() + 3 * std::ptrdiff_t{buffer.first_vertex});
  }
  return vertices;
}

void play(const std::vector<char>& file, const samples::GltfCharacter& clips) {
  const Model model(file.data(), file.size(), nullptr, 0, SC_LAYOUT_UNSET);
  if (!model) throw std::runtime_error(model.message());
  check_buffers(model.asset(), clips);
  Body body(model);

  for (int frame = 0; frame < clips.frame_count(0, 5); ++frame) {
    const std::vector<float> vertices = skin(model.asset(), clips, clips.palette(0, frame / 5.0));
    Pose pose;
    pose.vertices = vertices.data();
    pose.vertex_count = vertices.size() / 3;
    check(body.set_pose(pose));
    const SpherePairs spheres = body.sphere_pairs();
    check(body.status());
    const Contacts contacts = body.contacts();
    check(body.status());
    std::printf("frame %d: %zu pairs of spheres, %zu pairs of body parts\n", frame, spheres.total, contacts.part_count);
    for (const PartContact& contact : contacts) {
      std::printf("  %s in %s\n", model.part_name(contact.part_a), model.part_name(contact.part_b));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: load_and_refit ASSET.sphc MODEL.glb\n", stderr);
    return 2;
  }
  try {
    const std::vector<char> file = samples::read_file(argv[1]);
    play(file, samples::GltfCharacter(argv[2]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "load_and_refit: error: %s\n", error.what());
    return 3;
  }
  return 0;
}
