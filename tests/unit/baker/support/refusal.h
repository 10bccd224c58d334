// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "baker/import/import.h"
#include "baker/mesh/error.h"

// The message with which `import` refuses `file`: one line with the file's name first. "accepted" if it does not.
template <typename Import>
std::string refusal(const std::filesystem::path& file, const Import& import) {
  try {
    import(file);
  } catch (const spherechain::baker::Error& error) {
    CHECK(error.code() == spherechain::baker::ExitCode::kFile);
    const std::string what = error.what();
    CHECK(what.find(file.string()) == 0);
    CHECK(what.find('\n') == std::string::npos);
    return what;
  }
  return "accepted";
}

inline std::string refusal(const std::filesystem::path& file) {
  return refusal(file, [](const auto& path) { spherechain::baker::import_character(path); });
}

inline bool contains(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }
