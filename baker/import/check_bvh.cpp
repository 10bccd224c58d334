// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/check_bvh.h"

#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "mesh/error.h"

namespace spherechain::baker {

void check_bvh(const std::filesystem::path& path) {
  constexpr std::size_t kNestedMax = 500;
  constexpr double kFramesMax = 1e7, kSecondsMax = 1000;
  const auto refuse = [&](const std::string& what) { throw Error(ExitCode::kFile, path.string() + ": " + what); };
  std::ifstream file(path);
  std::string word;
  if (!(file >> word) || word != "HIERARCHY") return;
  std::vector<bool> has_children;  // of the joints whose braces are open
  while (file >> word && word != "MOTION") {
    if (word == "{") has_children.push_back(false);
    if (word == "}" && !has_children.empty()) has_children.pop_back();
    if (has_children.size() > kNestedMax) refuse("has more than 500 joints within each other");
    if (word == "JOINT" && !has_children.empty()) has_children.back() = true;
    if (word == "CHANNELS" && !has_children.empty() && has_children.back()) {
      refuse("names a joint's channels after its children (put them before)");
    }
  }
  if (!(file >> word) || word != "Frames:" || !(file >> word)) refuse("ends before its motion");
  const double frames = std::strtod(word.c_str(), nullptr);
  if (!(frames >= 1 && frames <= kFramesMax)) refuse("has " + word + " frames (write 1 to 10 million)");
  std::string frame, time;
  if (!(file >> frame >> time >> word) || frame != "Frame" || time != "Time:") refuse("has no frame time");
  const double seconds = std::strtod(word.c_str(), nullptr);
  if (!(seconds > 0 && seconds <= kSecondsMax)) {
    refuse("has a frame time of " + word + " (write seconds, more than 0 and at most 1000)");
  }
}

}  // namespace spherechain::baker
