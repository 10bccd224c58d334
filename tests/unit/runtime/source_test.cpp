// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "tiny_asset.h"

namespace spherechain::test {

TEST_CASE("the hash of positions is FNV-1a over their little-endian bytes") {
  // Reference values from an implementation in Python.
  CHECK(sc_hash_positions(nullptr, 0, 12) == 0xcbf29ce484222325U);
  const float zeros[3] = {};
  CHECK(sc_hash_positions(zeros, 1, 12) == 0x5467b0da1d106495U);
  const float values[6] = {1.0F, -2.0F, 3.5F, 0.0F, 1e-3F, -7.0F};
  CHECK(sc_hash_positions(values, 2, 12) == 0xc1a5c47dd2b96d98U);
}

TEST_CASE("negative zero hashes as zero") {
  const float positive[3] = {0.0F, 1.0F, 0.0F};
  const float negative[3] = {-0.0F, 1.0F, -0.0F};
  CHECK(sc_hash_positions(negative, 1, 12) == sc_hash_positions(positive, 1, 12));
}

TEST_CASE("the hash looks at every coordinate and skips what a stride skips") {
  const float packed[6] = {1, 2, 3, 4, 5, 6};
  const float padded[10] = {1, 2, 3, 99, 98, 4, 5, 6, 97, 96};
  CHECK(sc_hash_positions(padded, 2, 20) == sc_hash_positions(packed, 2, 12));
  for (int i = 0; i < 6; ++i) {
    float changed[6];
    std::copy(packed, packed + 6, changed);
    changed[i] += 0.5F;
    CHECK(sc_hash_positions(changed, 2, 12) != sc_hash_positions(packed, 2, 12));
  }
}

TEST_CASE("the buffers that the asset was baked from are accepted, any other refused") {
  const TinyAsset tiny = random_asset(3, 1);
  const OpenedAsset opened(tiny.parts);
  const std::size_t count = tiny.parts.vertex_count;
  const Asset closed{};
  struct Call {
    std::size_t buffer, first, count;
  };
  for (const Call call : {Call{SC_WHOLE_SOURCE, 0, count}, Call{0, 0, 4}, Call{1, 4, count - 4}}) {
    CAPTURE(call.buffer);
    std::vector<float> own(tiny.rest.begin() + static_cast<std::ptrdiff_t>(3 * call.first),
                           tiny.rest.begin() + static_cast<std::ptrdiff_t>(3 * (call.first + call.count)));
    const auto check = [&](const Asset* asset, const float* positions, std::size_t given, std::size_t stride) {
      return sc_check_source(asset, call.buffer, positions, given, stride);
    };
    CHECK(check(&opened.asset, own.data(), call.count, 12) == SC_OK);
    CHECK(check(&opened.asset, own.data(), call.count - 1, 12) == sc_status{SC_TOO_SMALL, SC_FIELD_VERTEX_COUNT});
    CHECK(check(&opened.asset, own.data(), call.count, 10) == sc_status{SC_BAD_STRIDE, SC_FIELD_VERTEX_STRIDE});
    CHECK(check(&opened.asset, own.data(), call.count, 8) == sc_status{SC_BAD_STRIDE, SC_FIELD_VERTEX_STRIDE});
    CHECK(check(&opened.asset, nullptr, call.count, 12) == sc_status{SC_NULL, SC_FIELD_VERTICES});
    const auto* askew = reinterpret_cast<const float*>(reinterpret_cast<const char*>(own.data()) + 2);
    CHECK(check(&opened.asset, askew, call.count, 12) == sc_status{SC_MISALIGNED, SC_FIELD_VERTICES});
    CHECK(check(&closed, own.data(), call.count, 12) == sc_status{SC_NOT_OPEN, SC_FIELD_ASSET});
    CHECK(check(nullptr, own.data(), call.count, 12) == sc_status{SC_NULL, SC_FIELD_ASSET});
    own.back() += 1e-3F;
    CHECK(check(&opened.asset, own.data(), call.count, 12) == sc_status{SC_WRONG_SOURCE, SC_FIELD_VERTICES});
    own.back() -= 1e-3F;
    own.insert(own.end(), {1, 2, 3});
    CHECK(check(&opened.asset, own.data(), call.count + 1, 12) == SC_OK);
  }
  CHECK(sc_check_source(&opened.asset, 2, tiny.rest.data(), count, 12) == sc_status{SC_BAD_VALUE, SC_FIELD_INDEX});
}

}  // namespace spherechain::test
