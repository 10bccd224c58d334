// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "import/import.h"
#include "mesh/error.h"

// What importing `file` says when it is refused: one line that begins with the file's name. "accepted" where it is not.
inline std::string refusal(const std::filesystem::path& file) {
  try {
    spherechain::baker::import_character(file);
  } catch (const spherechain::baker::Error& error) {
    CHECK(error.code() == spherechain::baker::ExitCode::kFile);
    const std::string what = error.what();
    CHECK(what.find(file.string()) == 0);
    CHECK(what.find('\n') == std::string::npos);
    return what;
  }
  return "accepted";
}

inline bool contains(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }
