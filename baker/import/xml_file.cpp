// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/xml_file.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string_view>

#include "baker/import/named_file.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {

std::string xml_root_name(const std::filesystem::path& path) {
  constexpr std::size_t kBytesMax = 1 << 16;  // comments with a licence come before the root
  std::string bytes(kBytesMax, '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  std::string_view text = bytes;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    const bool is_comment = text.starts_with("<!--");
    if (!is_comment && !text.starts_with("<?") && !text.starts_with("<!")) break;
    const std::string_view end = is_comment ? "-->" : ">";
    // A document type may have declarations in brackets.
    const std::size_t bracket = text.starts_with("<!DOCTYPE") ? text.find_first_of("[>") : text.npos;
    const bool has_declarations = bracket != text.npos && text[bracket] == '[';
    const std::size_t at = text.find(end, has_declarations ? text.find(']', bracket) : 0);
    if (at == text.npos) return {};
    text.remove_prefix(at + end.size());
  }
  if (!text.starts_with("<")) return {};
  text.remove_prefix(1);
  return std::string(text.substr(0, std::min(text.find_first_of(" \t\r\n/>"), text.size())));
}

XmlFile::XmlFile(const std::filesystem::path& path) : name_(path.string()) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  if (!in) fail("cannot be read");
  const std::string text = std::move(bytes).str();
  const pugi::xml_parse_result result = document_.load_buffer(text.data(), text.size());
  if (!result) fail("is no XML at byte " + std::to_string(result.offset) + " (" + result.description() + ")");
}

void XmlFile::fail(const std::string& what) const { throw Error(ExitCode::kFile, name_ + ": " + what); }

std::vector<double> XmlFile::numbers(pugi::xml_attribute attribute, std::size_t least, std::size_t most) const {
  std::vector<double> out;
  if (!attribute) return out;
  const std::string_view text = attribute.value();
  constexpr const char* kSpaces = " \t\r\n,";
  bool is_good = true;
  for (std::size_t at = text.find_first_not_of(kSpaces); at < text.size() && is_good;) {
    const std::size_t end = std::min(text.find_first_of(kSpaces, at), text.size());
    if (text[at] == '+') ++at;
    double value = 0;
    const auto [last, error] = std::from_chars(text.data() + at, text.data() + end, value);
    is_good = error == std::errc() && last == text.data() + end && std::isfinite(value) && out.size() < most;
    out.push_back(value);
    at = text.find_first_not_of(kSpaces, end);
  }
  if (!is_good || out.size() < least) {
    const std::string count =
        least == most ? std::to_string(least) : std::to_string(least) + " to " + std::to_string(most);
    fail(std::string(attribute.name()) + "=" + in_quotes(attribute.value()) + " is not " + count +
         (most == 1 ? " number" : " numbers"));
  }
  return out;
}

std::optional<double> XmlFile::number(pugi::xml_attribute attribute) const {
  const std::vector<double> values = numbers(attribute, 1, 1);
  return values.empty() ? std::nullopt : std::optional(values[0]);
}

std::optional<Vec3> XmlFile::vector(pugi::xml_attribute attribute) const {
  const std::vector<double> values = numbers(attribute, 3, 3);
  return values.empty() ? std::nullopt : std::optional(Vec3(values[0], values[1], values[2]));
}

std::string in_words(pugi::xml_node element) {
  const pugi::xml_attribute name = element.attribute("name");
  return name ? element.name() + (" " + in_quotes(name.value())) : "a " + std::string(element.name());
}

}  // namespace spherechain::baker
