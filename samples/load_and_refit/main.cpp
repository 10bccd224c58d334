// SPDX-License-Identifier: MIT
// load_and_refit ASSET REST POSED: spheres from deformed vertices. REST and POSED are the source's vertices as they lie
// in memory: x y z of each, 32-bit floats.
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

#include "spherechain/detect.h"
#include "spherechain/refit.h"

using namespace spherechain;

namespace {

std::vector<char> read(const char* path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<float> read_positions(const char* path) {
  const std::vector<char> bytes = read(path);
  std::vector<float> positions(bytes.size() / sizeof(float));
  if (!positions.empty()) {
    std::memcpy(positions.data(), bytes.data(), positions.size() * sizeof(float));
  }
  return positions;
}

int fail(const char* file, const char* what) {
  std::fprintf(stderr, "load_and_refit: error: %s: %s\n", file, what);
  return 3;
}

struct Found {
  Status status;
  std::size_t pairs;
};

Found refit_and_count(const Asset& asset, const std::vector<float>& positions, VertexSet vertices,
                      std::vector<Sphere>& spheres) {
  RefitJob refit;
  refit.asset = &asset;
  refit.positions = positions.data();
  refit.vertex_count = positions.size() / 3;
  refit.vertices = vertices;
  refit.spheres = {spheres.data(), spheres.size()};
  if (const Status status = refit.run(); status != Status::kOk) {
    return {status, 0};
  }
  DetectJob detect;  // no buffer for pairs: counts
  detect.asset = &asset;
  detect.spheres = {spheres.data(), spheres.size()};
  const Status status = detect.run();
  return {status, detect.pair_count};
}

// Who skins on the CPU only for this skins the pivots' vertices alone.
std::vector<float> pivots_alone(const Asset& asset, const std::vector<float>& positions) {
  std::vector<float> packed;
  for (const std::uint32_t vertex : asset.pivot_vertices()) {
    packed.insert(packed.end(), positions.begin() + 3 * std::ptrdiff_t{vertex},
                  positions.begin() + 3 * std::ptrdiff_t{vertex} + 3);
  }
  return packed;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: load_and_refit ASSET.sphc REST.f32 POSED.f32\n", stderr);
    return 2;
  }
  const std::vector<char> bytes = read(argv[1]);
  if (bytes.empty()) {
    return fail(argv[1], "cannot be read");
  }
  Asset asset;
  char message[160];
  if (asset.open(bytes.data(), bytes.size(), message, sizeof message) != Status::kOk) {
    return fail(argv[1], message);
  }

  // A buffer in another order gives nonsense and no error: so ask, once, with the rest pose.
  const std::vector<float> rest = read_positions(argv[2]);
  if (const Status status = check_source(asset, rest.data(), rest.size() / 3); status != Status::kOk) {
    return fail(argv[2], to_string(status));
  }
  const std::vector<float> posed = read_positions(argv[3]);

  std::vector<Sphere> spheres(asset.spheres().size), packed_spheres(spheres.size());
  const Found at_rest = refit_and_count(asset, rest, VertexSet::kSource, spheres);
  const Found found = refit_and_count(asset, posed, VertexSet::kSource, spheres);
  if (found.status != Status::kOk) {
    return fail(argv[3], to_string(found.status));
  }
  const std::vector<float> packed = pivots_alone(asset, posed);
  const Found by_pivots = refit_and_count(asset, packed, VertexSet::kPivots, packed_spheres);
  std::printf("at rest %zu pairs, posed %zu\n", at_rest.pairs, found.pairs);
  std::printf("from %zu of %u vertices %zu: %s spheres\n", packed.size() / 3, asset.info().source_vertex_count,
              by_pivots.pairs,
              std::memcmp(spheres.data(), packed_spheres.data(), spheres.size() * sizeof(Sphere)) == 0 ? "the very same"
                                                                                                       : "other");
  return 0;
}
