// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <random>

#include "crowd_body.h"

namespace spherechain::test {

TEST_CASE("the kernel's quotient is the rounded one, for scales and means of every size it is used for") {
  std::mt19937_64 random(1);
  const auto any_float = [&](int least, int most) {
    const auto mantissa = static_cast<float>(1.0 + static_cast<double>(random() % (1U << 23)) * 0x1p-23);
    return std::ldexp(mantissa, least + static_cast<int>(random() % static_cast<unsigned>(most - least)));
  };
  std::size_t wrong = 0;
  for (int i = 0; i < 3'000'000; ++i) {
    const float a = any_float(-50, 50), b = any_float(-60, 60);
    wrong += cuda::usual_quotient(a, b, 1 / b) != a / b ? 1U : 0U;
  }
  for (std::uint32_t low = 0; low < 2000; ++low) {  // mantissas near 2, where the rounded 1 / b is worst
    const float b = std::ldexp(static_cast<float>((1U << 24) - 1 - low), -24);
    for (std::uint32_t k = 0; k < 500; ++k) {
      const float a = std::ldexp(static_cast<float>((1U << 24) - 1 - k * 7), -24);
      wrong += cuda::usual_quotient(a, b, 1 / b) != a / b ? 1U : 0U;
    }
  }
  CHECK(wrong == 0);
}

}  // namespace spherechain::test
