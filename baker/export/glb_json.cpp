// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/export/glb_json.h"

#include <algorithm>

#include "baker/mesh/error.h"

namespace spherechain::baker {

using nlohmann::ordered_json;

namespace {

constexpr std::size_t kJsonStart = 20;  // after the header and the first chunk's length and type

std::size_t word_at(const std::string& bytes, std::size_t at) {
  std::size_t out = 0;
  for (std::size_t k = 4; k-- > 0;) out = out << 8 | static_cast<unsigned char>(bytes[at + k]);
  return out;
}

std::string word_of(std::size_t value) {
  std::string out;
  for (int k = 0; k < 4; ++k) out.push_back(static_cast<char>(value >> (8 * k) & 0xFF));
  return out;
}

std::size_t json_end(const std::string& bytes) {
  const std::size_t end = bytes.size() < kJsonStart ? 0 : kJsonStart + word_at(bytes, 12);
  if (!bytes.starts_with("glTF") || end == 0 || end > bytes.size()) {
    throw Error(ExitCode::kInternal, "the source is no binary glTF");
  }
  return end;
}

}  // namespace

ordered_json json_of_glb(const std::string& bytes) {
  ordered_json out =
      ordered_json::parse(bytes.substr(kJsonStart, json_end(bytes) - kJsonStart), nullptr, /*allow_exceptions=*/false);
  if (!out.is_object()) throw Error(ExitCode::kInternal, "the source is no binary glTF");
  return out;
}

std::string with_json(const std::string& bytes, const ordered_json& json) {
  const std::string rest = bytes.substr(json_end(bytes));
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  return bytes.substr(0, 8) + word_of(kJsonStart + text.size() + rest.size()) + word_of(text.size()) +
         bytes.substr(16, 4) + text + rest;
}

ordered_json& use_extension(ordered_json& json, const std::string& name) {
  ordered_json& used = array_in(json, "extensionsUsed");
  if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
  ordered_json& extension = json["extensions"][name];
  if (!extension.is_object()) extension = ordered_json::object();
  return extension;
}

void drop_extension(ordered_json& json, const std::string& name) {
  if (!json.contains("extensions")) return;
  json["extensions"].erase(name);
  if (json["extensions"].empty()) json.erase("extensions");
  ordered_json& used = array_in(json, "extensionsUsed");
  used.erase(std::remove(used.begin(), used.end(), name), used.end());
  if (used.empty()) json.erase("extensionsUsed");
}

ordered_json& array_in(ordered_json& object, const std::string& name) {
  ordered_json& out = object[name];
  if (!out.is_array()) out = ordered_json::array();
  return out;
}

bool is_own(const ordered_json& thing) {
  const ordered_json& name = entry_of(thing, "name");
  return name.is_string() && name.get_ref<const std::string&>().starts_with(kOwnName);
}

std::vector<int> take_out(ordered_json& array, const std::function<bool(std::size_t, const ordered_json&)>& is_out) {
  std::vector<int> went;
  ordered_json kept = ordered_json::array();
  for (std::size_t i = 0; i < array.size(); ++i) {
    const bool out = is_out(i, array[i]);
    went.push_back(out ? -1 : static_cast<int>(kept.size()));
    if (!out) kept.push_back(array[i]);
  }
  array = std::move(kept);
  return went;
}

void renumber(ordered_json& numbers, const std::vector<int>& went) {
  if (!numbers.is_array()) return;
  ordered_json kept = ordered_json::array();
  for (const ordered_json& number : numbers) {
    if (!number.is_number_unsigned() || number.get<std::size_t>() >= went.size()) {
      kept.push_back(number);
    } else if (const int at = went[number.get<std::size_t>()]; at >= 0) {
      kept.push_back(at);
    }
  }
  numbers = std::move(kept);
}

}  // namespace spherechain::baker
