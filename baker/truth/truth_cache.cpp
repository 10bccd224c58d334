// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/truth/truth_cache.h"

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>

#include "baker/os/sha256.h"
#include "baker/os/temporary.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

// Another one whenever what is kept, or what it is found from, is another.
constexpr std::string_view kFormat = "spherechain intersections 1\n";

template <typename T>
void append(std::string& text, const std::vector<T>& values) {
  text.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

// The format, the count of triangles without area, the pairs; and the hash of all that.
std::string to_bytes(const Intersections& found) {
  std::string bytes(kFormat);
  const std::uint64_t degenerate = found.degenerate;
  bytes.append(reinterpret_cast<const char*>(&degenerate), sizeof(degenerate));
  append(bytes, found.pairs);
  return bytes + sha256_of_text(bytes);
}

constexpr std::size_t kHashSize = 64, kFixedSize = kFormat.size() + sizeof(std::uint64_t) + kHashSize;

std::optional<Intersections> from_bytes(std::string_view bytes) {
  if (bytes.size() < kFixedSize || (bytes.size() - kFixedSize) % sizeof(Pair) != 0) return std::nullopt;
  const std::string_view content = bytes.substr(0, bytes.size() - kHashSize);
  if (!content.starts_with(kFormat) || sha256_of_text(content) != bytes.substr(content.size())) return std::nullopt;
  Intersections found;
  std::uint64_t degenerate = 0;
  std::memcpy(&degenerate, content.data() + kFormat.size(), sizeof(degenerate));
  found.degenerate = degenerate;
  found.pairs.resize((bytes.size() - kFixedSize) / sizeof(Pair));
  if (!found.pairs.empty()) {
    std::memcpy(found.pairs.data(), content.data() + kFormat.size() + sizeof(degenerate),
                found.pairs.size() * sizeof(Pair));
  }
  return found;
}

std::optional<Intersections> read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  return from_bytes(std::string(std::istreambuf_iterator<char>(in), {}));
}

void write(const fs::path& file, const std::string& bytes) {
  Temporary temporary(file);
  if (temporary.is_open() && temporary.write(bytes)) temporary.rename_to_target();
}

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

fs::path cache_folder() {
  const std::string own = environment("SPHERECHAIN_CACHE");
  if (!own.empty()) return own == "off" ? fs::path() : fs::path(own);
  if (const std::string cache = environment("XDG_CACHE_HOME"); !cache.empty()) return fs::path(cache) / "spherechain";
  if (const std::string home = environment("HOME"); !home.empty()) return fs::path(home) / ".cache/spherechain";
  return {};
}

CachedIntersections::CachedIntersections(const TruthSurface& surface, fs::path folder)
    : surface_(surface), folder_(std::move(folder)) {
  if (folder_.empty()) return;
  std::string bytes(kFormat);
  append(bytes, surface.source_triangle);
  append(bytes, surface.corners);
  append(bytes, surface.welded);
  surface_key_ = sha256_of_text(bytes);
  std::error_code failed;
  fs::create_directories(folder_, failed);
}

Intersections CachedIntersections::find(const std::vector<float>& positions) const {
  if (folder_.empty()) return find_intersections(surface_, positions);
  std::string key = surface_key_;
  append(key, positions);
  const fs::path file = folder_ / (sha256_of_text(key) + ".pairs");
  if (std::optional<Intersections> known = read(file)) return std::move(*known);
  Intersections found = find_intersections(surface_, positions);
  write(file, to_bytes(found));
  return found;
}

}  // namespace spherechain::baker
