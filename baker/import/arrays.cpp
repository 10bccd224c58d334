// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/arrays.h"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <fstream>

#include "baker/import/notes.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

enum class Layout { kNone, kNpy, kNpz, kPickle };

// By the first bytes, else by the ending. A zip archive of anything else is no .npz.
Layout layout_of(const std::filesystem::path& path) {
  std::string start(256, '\0'), ending = path.extension().string();
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const bool is_pickle = ending == ".pkl" || ending == ".pickle";
  if (start.starts_with("\x93NUMPY")) return Layout::kNpy;
  if (start.starts_with("PK\3\4")) {
    constexpr std::size_t kName = 30;
    const bool has_table = start.size() > kName && start.find(".npy", kName) != start.npos;
    return has_table || ending == ".npz" || is_pickle ? Layout::kNpz : Layout::kNone;
  }
  if (start.size() > 2 && start[0] == '\x80' && start[1] >= 2 && start[1] <= 5) return Layout::kPickle;
  return ending == ".npy"   ? Layout::kNpy
         : ending == ".npz" ? Layout::kNpz
         : is_pickle        ? Layout::kPickle
                            : Layout::kNone;
}

}  // namespace

bool is_arrays(const std::filesystem::path& path) { return layout_of(path) != Layout::kNone; }

Arrays read_arrays(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code failed;
  const std::uintmax_t size = std::filesystem::file_size(path, failed);
  constexpr std::uintmax_t kSizeMax = std::uintmax_t{1} << 31;
  if (!failed && size > kSizeMax) throw Error(ExitCode::kFile, name + ": is larger than 2 GB (save a part of it)");
  std::string bytes(failed ? 0 : size, '\0');
  std::ifstream file(path, std::ios::binary);
  if (failed || !file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    throw Error(ExitCode::kFile, name + ": cannot be read");
  }
  switch (layout_of(path)) {
    case Layout::kNpz:
      return parse_npz(bytes, name);
    case Layout::kPickle:
      return parse_pickle(bytes, name);
    default:
      return {{"", parse_npy(bytes, name)}};
  }
}

const Array* find_table(const Arrays& arrays, const std::string& name, const std::string& file) {
  const auto found = arrays.find(name);
  if (found == arrays.end()) return nullptr;
  const std::string subject = file + ": " + (name.empty() ? "its table" : "'" + name + "'");
  const Array& out = found->second;
  if (!out.refused.empty()) throw Error(ExitCode::kFile, subject + " " + out.refused);
  constexpr double kLargest = 1e9;
  for (const double x : out.numbers) {
    if (!(std::abs(x) <= kLargest)) throw Error(ExitCode::kFile, subject + " has a number that is not finite, or huge");
  }
  return &out;
}

double frame_rate(const Arrays& arrays, const std::string& file) {
  for (const char* name : {"mocap_framerate", "mocap_frame_rate", "fps", "frame_rate"}) {
    const Array* found = find_table(arrays, name, file);
    if (found == nullptr) continue;
    constexpr double kMin = 1e-3, kMax = 1e4;
    if (found->numbers.size() != 1 || found->numbers[0] < kMin || found->numbers[0] > kMax)
      throw Error(ExitCode::kFile, fmt::format("{}: '{}' is no number of frames a second", file, name));
    return found->numbers[0];
  }
  constexpr double kUsual = 30;
  add_note(fmt::format("{}: names no frame rate: {} frames a second are taken (an .npz or a pickle can have 'fps')",
                       file, kUsual));
  return kUsual;
}

}  // namespace spherechain::baker
