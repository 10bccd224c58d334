// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/layers/pieces.h"

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <utility>

namespace spherechain::baker {
namespace {

// The buffer of each of the source's triangles.
std::vector<Index> buffers_of_triangles(const Character& character) {
  std::vector<Index> out;
  for (const SourceBuffer& buffer : character.buffers) {
    out.insert(out.end(), buffer.triangle_count, static_cast<Index>(&buffer - character.buffers.data()));
  }
  return out;
}

// Each of its words once: exporters name node, mesh and material alike.
std::string without_repeats(const std::string& names) {
  std::istringstream in(names);
  std::vector<std::string> words;
  std::string out;
  for (std::string word; in >> word;) {
    if (std::ranges::find(words, word) != words.end()) continue;
    words.push_back(word);
    out += (out.empty() ? "" : " ") + word;
  }
  return out;
}

}  // namespace

std::vector<std::uint32_t> number_pieces(const Surface& surface) {
  std::vector<std::uint32_t> out(surface.pieces.size);
  std::uint32_t next = 0;
  for (std::uint32_t v = 0; v < out.size(); ++v) {
    out[v] = surface.pieces[v] == v ? next++ : out[surface.pieces[v]];
  }
  return out;
}

std::vector<SkinPiece> find_pieces(const Surface& surface, const Character& character) {
  const std::vector<std::uint32_t> number = number_pieces(surface);
  std::vector<SkinPiece> out;
  if (!number.empty()) out.resize(std::size_t{*std::max_element(number.begin(), number.end())} + 1);
  const std::vector<Index> buffers = buffers_of_triangles(character);
  std::vector<std::map<Index, std::size_t>> counts(out.size());  // of each piece: triangles by buffer
  std::map<std::pair<std::uint32_t, std::uint32_t>, unsigned> edges;
  for (std::size_t t = 0; t < surface.triangles.size; ++t) {
    const std::uint32_t* const corners = surface.triangle_vertices.data + 3 * t;
    ++counts[number[corners[0]]][buffers[surface.triangles[t]]];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = surface.welds[corners[k]], b = surface.welds[corners[(k + 1) % 3]];
      ++edges[std::minmax(a, b)];
    }
  }
  for (std::size_t p = 0; p < out.size(); ++p) {
    const auto most = std::ranges::max_element(counts[p], {}, [](const auto& entry) { return entry.second; });
    if (most != counts[p].end()) out[p].name = without_repeats(character.buffers[most->first].name);
  }
  const auto position = [&](std::uint32_t v) {
    const float* const at = surface.rest_positions.data + 3 * std::size_t{v};
    return Vec3(at[0], at[1], at[2]);
  };
  for (const auto& [edge, count] : edges) {
    if (count == 1) out[number[edge.first]].border += (position(edge.second) - position(edge.first)).norm();
  }
  return out;
}

}  // namespace spherechain::baker
