// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "spherechain/asset.h"
#include "tiny_asset.h"

namespace spherechain::test {

TEST_CASE("the hash of positions is FNV-1a over their little-endian bytes") {
  // Reference values from an implementation in Python.
  CHECK(hash_positions(nullptr, 0) == 0xcbf29ce484222325U);
  const float zeros[3] = {};
  CHECK(hash_positions(zeros, 1) == 0x5467b0da1d106495U);
  const float values[6] = {1.0F, -2.0F, 3.5F, 0.0F, 1e-3F, -7.0F};
  CHECK(hash_positions(values, 2) == 0xc1a5c47dd2b96d98U);
}

TEST_CASE("negative zero hashes as zero") {
  const float positive[3] = {0.0F, 1.0F, 0.0F};
  const float negative[3] = {-0.0F, 1.0F, -0.0F};
  CHECK(hash_positions(negative, 1) == hash_positions(positive, 1));
}

TEST_CASE("the hash looks at every coordinate and skips what a stride skips") {
  const float packed[6] = {1, 2, 3, 4, 5, 6};
  const float padded[10] = {1, 2, 3, 99, 98, 4, 5, 6, 97, 96};
  CHECK(hash_positions(padded, 2, 20) == hash_positions(packed, 2));
  for (int i = 0; i < 6; ++i) {
    float changed[6];
    std::copy(packed, packed + 6, changed);
    changed[i] += 0.5F;
    CHECK(hash_positions(changed, 2) != hash_positions(packed, 2));
  }
}

TEST_CASE("the buffer the asset was baked from is accepted, any other refused") {
  const TinyAsset tiny = random_asset(3, 1);
  const OpenedAsset opened(tiny.parts);
  const std::size_t count = tiny.parts.vertex_count;
  CHECK(check_source(opened.asset, tiny.rest.data(), count) == Status::kOk);

  std::vector<float> longer = tiny.rest;
  longer.insert(longer.end(), {1.0F, 2.0F, 3.0F});
  CHECK(check_source(opened.asset, longer.data(), count + 1) == Status::kOk);

  std::vector<float> moved = tiny.rest;
  moved.back() += 1e-3F;
  CHECK(check_source(opened.asset, moved.data(), count) == Status::kWrongSource);
  CHECK(check_source(opened.asset, moved.data(), count - 1) == Status::kTooFewVertices);
  CHECK(check_source(opened.asset, moved.data(), count, 10) == Status::kBadStride);
  CHECK(check_source(opened.asset, moved.data(), count, 8) == Status::kBadStride);
  CHECK(check_source(opened.asset, nullptr, count) == Status::kNullArgument);
  CHECK(check_source(Asset(), moved.data(), count) == Status::kNotOpen);
}

TEST_CASE("each buffer of the source's file is told from every other") {
  TinyAsset tiny = random_asset(3, 1);
  const OpenedAsset opened(tiny.parts);
  const std::size_t rest = tiny.parts.vertex_count - 4;
  CHECK(check_source_part(opened.asset, 0, tiny.rest.data(), 4) == Status::kOk);
  CHECK(check_source_part(opened.asset, 0, tiny.rest.data(), 5) == Status::kOk);
  CHECK(check_source_part(opened.asset, 1, tiny.rest.data() + 12, rest) == Status::kOk);
  CHECK(check_source_part(opened.asset, 1, tiny.rest.data(), rest) == Status::kWrongSource);
  CHECK(check_source_part(opened.asset, 0, tiny.rest.data(), 3) == Status::kTooFewVertices);
  CHECK(check_source_part(opened.asset, 0, tiny.rest.data(), 4, 10) == Status::kBadStride);
  CHECK(check_source_part(opened.asset, 2, tiny.rest.data(), 4) == Status::kBadArgument);
  CHECK(check_source_part(opened.asset, 0, nullptr, 4) == Status::kNullArgument);
  CHECK(check_source_part(Asset(), 0, tiny.rest.data(), 4) == Status::kNotOpen);
  tiny.rest[11] += 1e-3F;
  CHECK(check_source_part(opened.asset, 0, tiny.rest.data(), 4) == Status::kWrongSource);
}

}  // namespace spherechain::test
