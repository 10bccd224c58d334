// SPDX-License-Identifier: MIT
#include "gltf_pose_c.h"

#include <cstdio>
#include <stdexcept>

#include "gltf_pose.h"

struct gltf_character {
  samples::GltfCharacter model;
  std::vector<sc_bone> joints;
  samples::Palette palette;
};

extern "C" {

gltf_character* gltf_open(const char* path, char* message, size_t message_size) {
  try {
    samples::GltfCharacter model(path);
    auto* const character = new gltf_character{std::move(model), {}, {}};
    character->joints = character->model.joints();
    gltf_palette(character, 0);
    return character;
  } catch (const std::exception& error) {
    std::snprintf(message, message_size, "%s", error.what());
    return nullptr;
  }
}

void gltf_close(gltf_character* character) { delete character; }

const sc_bone* gltf_joints(const gltf_character* character, size_t* count) {
  *count = character->joints.size();
  return character->joints.data();
}

double gltf_duration(const gltf_character* character) { return character->model.duration(0); }

const float* gltf_palette(gltf_character* character, double seconds) {
  character->palette = character->model.palette(0, seconds);
  return character->palette[0].data();
}

}  // extern "C"
