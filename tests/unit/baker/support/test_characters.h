// SPDX-License-Identifier: GPL-3.0-or-later
// The rigged glTF and FBX characters of the folder that SPHERECHAIN_TEST_DATA names.
#pragma once

#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "baker/pipeline/pipeline.h"

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
    const std::string ending = file.path().extension();
    if (ending != ".glb" && ending != ".gltf" && ending != ".fbx") continue;
    check(bake(file.path(), make_settings("balanced", "{}", "test"), {}));
    ++count;
  }
  CHECK(count > 0);
}
