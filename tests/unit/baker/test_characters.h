// SPDX-License-Identifier: GPL-3.0-or-later
// The rigged glTF characters of the folder that SPHERECHAIN_TEST_DATA names. What is skipped is printed.
#pragma once

#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>

#include "mesh/error.h"
#include "pipeline/pipeline.h"

template <typename Check>
void for_each_test_character(const Check& check) {
  const char* folder = std::getenv("SPHERECHAIN_TEST_DATA");
  if (folder == nullptr) {
    MESSAGE("skipped: SPHERECHAIN_TEST_DATA names no folder of rigged characters");
    return;
  }
  using namespace spherechain::baker;
  std::size_t count = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    if (file.path().extension() != ".glb" && file.path().extension() != ".gltf") continue;
    std::optional<Bake> baked;
    try {
      baked.emplace(bake(file.path(), make_settings("balanced", "{}", "test"), {}));
    } catch (const Error& refused) {
      if (refused.code() != ExitCode::kSegmentation) throw;
      MESSAGE("skipped: ", refused.what());
      continue;
    }
    check(*baked);
    ++count;
  }
  CHECK(count > 0);
}
