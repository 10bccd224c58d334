// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/motion/sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "baker/import/named_file.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {

namespace fs = std::filesystem;

bool is_sequence(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) || path.extension() == ".txt";
}

std::vector<fs::path> sequence_files(const fs::path& folder_or_list) {
  std::vector<fs::path> files;
  std::error_code error;
  if (fs::is_directory(folder_or_list, error)) {
    for (fs::directory_iterator entry(folder_or_list, error), end; !error && entry != end; entry.increment(error)) {
      // Materials and pictures lie beside meshes.
      const std::string extension = entry->path().extension().string();
      static constexpr const char* kBeside[] = {".mtl", ".png", ".jpg", ".jpeg", ".tga", ".txt", ".md", ".json"};
      const bool beside = std::find(std::begin(kBeside), std::end(kBeside), extension) != std::end(kBeside);
      std::error_code ignored;
      if (entry->is_regular_file(ignored) && !beside) files.push_back(entry->path());
    }
    if (error) throw Error(ExitCode::kFile, folder_or_list.string() + ": cannot be read (" + error.message() + ")");
    std::sort(files.begin(), files.end());
  } else {
    check_regular_file(folder_or_list);
    std::ifstream list(folder_or_list);
    if (!list) throw Error(ExitCode::kFile, folder_or_list.string() + ": cannot be read");
    for (std::string line; std::getline(list, line);) {
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (line.empty()) continue;
      const NamedFile mesh = named_file(folder_or_list.parent_path(), line);
      if (mesh.refusal != nullptr) {
        throw Error(ExitCode::kFile, folder_or_list.string() + ": the mesh " + in_quotes(line) + " " + mesh.refusal);
      }
      files.push_back(mesh.path);
    }
  }
  if (files.empty()) throw Error(ExitCode::kFile, folder_or_list.string() + ": has no meshes to play");
  return files;
}

SequenceMotion::SequenceMotion(const Character& character, const std::vector<fs::path>& files, Path path)
    : path_(path) {
  if (path == Path::kBezier) keys_.push_back(character.source_positions);
  for (const fs::path& file : files) {
    const Character frame = import_character(file);
    if (frame.source_positions.size() != character.source_positions.size() ||
        frame.source_triangles != character.source_triangles) {
      throw Error(ExitCode::kFile,
                  fmt::format("{}: has other vertices or triangles than {} ({} and {}, not {} and {})", file.string(),
                              character.file, frame.source_positions.size(), frame.source_triangles.size(),
                              character.source_positions.size(), character.source_triangles.size()));
    }
    keys_.push_back(frame.source_positions);
  }
}

Deformation SequenceMotion::at(double t) const {
  Deformation out;
  const double along = std::clamp(t, 0.0, 1.0) * static_cast<double>(keys_.size() - 1);
  const std::size_t step = path_ == Path::kBezier ? 2 : 1;
  const std::size_t first = std::min(static_cast<std::size_t>(along) / step * step, keys_.size() - 1);
  const std::size_t last = std::min(first + step, keys_.size() - 1);
  const double u = last > first ? (along - static_cast<double>(first)) / static_cast<double>(last - first) : 0;
  const std::vector<Vec3>&a = keys_[first], &b = keys_[last];
  out.positions.resize(a.size());
  for (std::size_t v = 0; v < a.size(); ++v) {
    if (last - first == 2) {
      // The control point that leads the curve through the pose in the middle.
      const Vec3 control = 2 * keys_[first + 1][v] - 0.5 * (a[v] + b[v]);
      out.positions[v] = (1 - u) * (1 - u) * a[v] + 2 * u * (1 - u) * control + u * u * b[v];
    } else {
      out.positions[v] = (1 - u) * a[v] + u * b[v];
    }
  }
  return out;
}

}  // namespace spherechain::baker
