// SPDX-License-Identifier: MIT
// write_palettes MODEL.glb OUT: what an engine's animation system would give Hello.cs. Little-endian: the numbers of
// joints and frames (int32); each joint's name (int32 length, UTF-8) and inverse bind matrix; the palette at rest; a
// palette a frame of the first clip, 30 a second. Matrices are 16 floats, SC_COLUMNS_4X4.
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>

#include "gltf_pose.h"

static void write(std::ofstream& out, const void* data, std::size_t size) {
  out.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
}

static void write(std::ofstream& out, std::int32_t number) { write(out, &number, sizeof number); }

static void write(std::ofstream& out, const samples::Palette& palette) {
  write(out, palette.data(), palette.size() * sizeof(samples::Matrix));
}

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: write_palettes MODEL.glb OUT\n", stderr);
    return 2;
  }
  try {
    const samples::GltfCharacter model(argv[1]);
    const std::vector<spherechain::Bone> joints = model.joints();
    const int frames = model.frame_count(0, 30);
    std::ofstream out(argv[2], std::ios::binary);
    write(out, static_cast<std::int32_t>(joints.size()));
    write(out, static_cast<std::int32_t>(frames));
    for (const spherechain::Bone& joint : joints) {
      const std::size_t length = std::strlen(joint.name);
      write(out, static_cast<std::int32_t>(length));
      write(out, joint.name, length);
      write(out, joint.inverse_bind, sizeof(samples::Matrix));
    }
    write(out, model.rest_palette());
    for (int frame = 0; frame < frames; ++frame) write(out, model.palette(0, frame / 30.0));
    out.close();
    if (!out) throw std::runtime_error(std::string(argv[2]) + ": cannot be written");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "write_palettes: error: %s\n", error.what());
    return 3;
  }
  return 0;
}
