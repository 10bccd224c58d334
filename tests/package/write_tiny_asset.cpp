// SPDX-License-Identifier: MIT
// write_tiny_asset OUT: a synthetic asset with bones and a skin, for programs that have no baker.
#include <fstream>

#include "tiny_skin.h"

int main(int argc, char** argv) {
  using namespace spherechain::test;
  TinyAsset tiny = random_asset(60, 1);
  const TinySkin skin = add_bones(tiny, 9, 2);
  add_moments(tiny, skin);
  add_skin(tiny, &skin, 4);
  // Without layers, so that all programs count the same contacts.
  tiny.parts.skin.layer_pairs.clear();
  for (spherechain::PackedCluster& cluster : tiny.parts.skin.clusters) {
    cluster.is_buried = 0;
  }
  const std::vector<std::uint8_t> bytes = build(tiny.parts);
  std::ofstream file(argc > 1 ? argv[1] : "", std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return file.good() ? 0 : 3;
}
