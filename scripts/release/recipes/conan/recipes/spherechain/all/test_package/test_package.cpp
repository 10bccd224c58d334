// SPDX-License-Identifier: MIT
// Bytes that are no asset are refused: headers and library fit together.
#include <spherechain/spherechain.h>

#include <cstdio>

int main() {
  alignas(8) const unsigned char bytes[64] = {};
  const spherechain::Model model(bytes, sizeof bytes, nullptr, 0, SC_LAYOUT_UNSET);
  std::printf("spherechain: %s\n", model.message());
  return model.status() == SC_NOT_AN_ASSET ? 0 : 1;
}
