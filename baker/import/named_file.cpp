// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/named_file.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string_view>

#include "baker/import/notes.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOutside = "is outside the folder of the file";

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

// "http://", "file:/", "C:/", "C:skin.png". A colon elsewhere may be part of a file's name.
bool has_scheme(std::string_view name) {
  const auto end = std::find_if(name.begin(), name.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '+' && c != '-' && c != '.';
  });
  const auto length = static_cast<std::size_t>(end - name.begin());
  if (length == 0 || end == name.end() || *end != ':' || !is_letter(name[0])) return false;
  return length == 1 || name.substr(length + 1).starts_with("/");
}

// Why a name with slashes is refused by its words alone.
const char* refusal_of(std::string_view name) {
  if (name.empty()) return "is empty";
  if (name.find('\0') != name.npos) return "has a zero byte";
  if (name[0] == '/') return "is an absolute path";
  if (has_scheme(name)) return "is no file in the folder of the file";
  int depth = 0;
  for (const fs::path& part : fs::path(name)) {
    if (part == "..")
      --depth;
    else if (part != "." && !part.empty())
      ++depth;
    if (depth < 0) return kOutside;
  }
  return nullptr;
}

bool is_below(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

std::string with_slashes(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

std::string percent_decoded(std::string_view uri) {
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned char value = 0;
    const char* digits = uri.data() + i + 1;
    if (uri[i] == '%' && i + 2 < uri.size() && std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
      out += static_cast<char>(value);
      i += 2;
    } else {
      out += uri[i];
    }
  }
  return out;
}

}  // namespace

NamedFile named_file(const fs::path& folder, std::string name) {
  name = with_slashes(std::move(name));
  if (const char* refusal = refusal_of(name)) return {{}, false, refusal};
  const fs::path home = folder.empty() ? "." : folder, place = (home / name).lexically_normal();
  std::error_code no_folder, no_file;
  const fs::path real_home = fs::canonical(home, no_folder), real = fs::canonical(home / name, no_file);
  if (no_folder || no_file) return {place, false, nullptr};
  if (!is_below(real, real_home)) return {{}, false, "is a link that leads out of the folder of the file"};
  std::error_code ignored;
  // The place that was looked at is the one that is opened, whatever becomes of the links.
  return {real, fs::is_regular_file(real, ignored), nullptr};
}

NamedFile named_by_uri(const fs::path& folder, const std::string& uri) {
  return named_file(folder, percent_decoded(uri));
}

NamedFile named_picture(const fs::path& folder, std::string name) {
  name = with_slashes(std::move(name));
  const NamedFile whole = named_file(folder, name);
  for (std::size_t slash = name.find('/'); !whole.is_there && slash != name.npos; slash = name.find('/', slash + 1)) {
    if (NamedFile end = named_file(folder, name.substr(slash + 1)); end.is_there) return end;
  }
  return whole;
}

void LostFiles::add(const std::string& name, const NamedFile& file) {
  if (!file.is_there) lost_.push_back(in_quotes(name) + " " + file.what_is_wrong());
}

void LostFiles::note(const std::string& file) const {
  constexpr std::size_t kNamed = 3;
  if (lost_.empty()) return;
  std::string out = file + ": ";
  for (std::size_t i = 0; i < std::min(lost_.size(), kNamed); ++i) out += (i == 0 ? "not read: " : "; ") + lost_[i];
  if (lost_.size() > kNamed) out += "; and " + std::to_string(lost_.size() - kNamed) + " more";
  add_note(out);
}

std::string in_quotes(const std::string& name) {
  constexpr std::size_t kMax = 80;
  std::string out;
  for (const char c : name.substr(0, kMax)) {
    if (c == '\0')
      out += "\\u0000";  // which would end a message
    else
      out += c;
  }
  return "'" + out + (name.size() > kMax ? "..." : "") + "'";
}

}  // namespace spherechain::baker
