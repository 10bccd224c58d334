// SPDX-License-Identifier: MIT
// hello ASSET: from bones to what touches, on one page to copy from.
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

#include "skeleton.h"
#include "spherechain/contacts.h"
#include "spherechain/detect.h"
#include "spherechain/refit_bones.h"

using namespace spherechain;

static int fail(const char* file, const char* what) {
  std::fprintf(stderr, "hello: error: %s: %s\n", file, what);
  return 3;
}

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: hello ASSET.sphc\n", stderr);
    return 2;
  }

  // Once: the file's bytes, and a view of them. The bytes stay yours, and stay.
  std::ifstream file(argv[1], std::ios::binary);
  if (!file) {
    return fail(argv[1], "cannot be read");
  }
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  Asset asset;
  char message[160];
  if (asset.open(bytes.data(), bytes.size(), message, sizeof message) != Status::kOk) {
    return fail(argv[1], message);
  }

  // Once an asset, and again where a filter is edited: which pairs to look at. Without, detection takes twice as long.
  std::vector<std::uint64_t> table_words(DetectTable::words_needed(asset));
  DetectTable table{{table_words.data(), table_words.size()}};
  Status status = prepare_detect(asset, RadiusKind::kDetect, nullptr, table);

  // Once a character: its memory. Nothing below allocates.
  std::vector<Sphere> spheres(asset.spheres().size);
  std::vector<Pair> pairs(256);
  std::vector<Contact> contacts(pairs.size());

  // The palette you give the skinning shader. Here: the left arm swung down, into the flank.
  if (!samples::has_automatic_rig(asset)) {
    return fail(argv[1], "has bones of its own, and this sample animates automatic rigs alone");
  }
  samples::Palette palette = samples::rest_pose(asset);
  samples::turn(asset, palette, "left_shoulder", {0, 0, -42});

  // Every frame: spheres follow the bones ...
  RefitBonesJob refit;
  refit.asset = &asset;
  refit.bones = {palette[0].data(), palette.size(), MatrixLayout::kRowMajor3x4, sizeof palette[0]};
  refit.spheres = {spheres.data(), spheres.size()};
  status = status == Status::kOk ? refit.run() : status;

  // ... which of them touch ...
  DetectJob detect;
  detect.asset = &asset;
  detect.spheres = {spheres.data(), spheres.size()};
  detect.table = &table;
  detect.pairs = {pairs.data(), pairs.size()};
  status = status == Status::kOk ? detect.run() : status;

  // ... and how.
  ContactJob contact;
  contact.asset = &asset;
  contact.spheres = {spheres.data(), spheres.size()};
  contact.pairs = {pairs.data(), detect.pair_count};
  contact.contacts = {contacts.data(), contacts.size()};
  status = status == Status::kOk ? contact.run() : status;
  if (status != Status::kOk) {
    return fail(argv[1], to_string(status));
  }

  for (std::size_t i = 0; i < detect.pair_count; ++i) {
    const auto region_of = [&](std::uint32_t sphere) { return asset.region(asset.spheres()[sphere].region).name; };
    const double depth = 100.0 * static_cast<double>(contacts[i].depth / asset.info().height);
    std::printf("%s sphere %u in %s sphere %u, %.1f %% of the height deep\n", region_of(pairs[i].a), pairs[i].a,
                region_of(pairs[i].b), pairs[i].b, depth);
  }
  return 0;
}
