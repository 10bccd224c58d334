// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/obj_file.h"

#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

#include "baker/import/named_file.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBlank = " \t\r";

std::string_view without_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

}  // namespace

std::vector<fs::path> files_of_obj(const fs::path& path) {
  constexpr std::string_view kKeyword = "mtllib";
  std::vector<fs::path> files;
  std::ifstream file(path, std::ios::binary);
  for (std::string line; std::getline(file, line);) {
    std::string_view rest = without_blanks(line);
    if (rest.substr(0, kKeyword.size()) != kKeyword) continue;
    rest.remove_prefix(kKeyword.size());
    const std::string name(without_blanks(rest));
    if (name.empty() || name.size() == rest.size()) continue;  // another word that begins so
    // The format has several names in a line, assimp one with blanks in it.
    const auto add = [&](const std::string& one) {
      if (NamedFile named = named_file(path.parent_path(), one); !named.path.empty()) files.push_back(named.path);
    };
    add(name);
    std::istringstream words(name);
    for (std::string word; words >> word;) add(word);
  }
  if (!files.empty()) files.push_back(fs::path(path).replace_extension("mtl"));
  return files;
}

}  // namespace spherechain::baker
