// SPDX-License-Identifier: GPL-3.0-or-later
#include "edits/ignore_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "bind/neighbours.h"

namespace spherechain::baker {
namespace {

constexpr int kNone = -1;

class PartSpheres {
 public:
  PartSpheres(const Character& character, const Regions& regions, const Spheres& spheres, const BodyParts& parts,
              Binding& binding)
      : mesh_(character.skin), regions_(regions), spheres_(spheres), binding_(binding) {
    for (const Index source : character.skin_source_triangle) part_of_.push_back(parts.of_triangle[source]);
    std::vector<std::vector<double>> areas(spheres.spheres.size(), std::vector<double>(parts.parts.size(), 0.0));
    for (std::size_t t = 0; t < part_of_.size(); ++t) {
      areas[binding.sphere_of_triangle[t]][static_cast<std::size_t>(part_of_[t])] += triangle_area(mesh_, t);
    }
    for (const std::vector<double>& area : areas) {
      const auto most = std::max_element(area.begin(), area.end());
      of_sphere_.push_back(most == area.end() || *most <= 0 ? kNone : static_cast<int>(most - area.begin()));
    }
  }

  // Gives the triangles of a part to its spheres, and takes from them those of others.
  void separate(int part) {
    for (std::size_t t = 0; t < part_of_.size(); ++t) {
      std::uint32_t& owner = binding_.sphere_of_triangle[t];
      const int own = part_of_[t];
      if (of_sphere_[owner] == own || (own != part && of_sphere_[owner] != part)) continue;
      std::vector<std::uint32_t> among;
      for (const std::uint32_t s : spheres_.of_region[regions_.of_skin[t]]) {
        if (of_sphere_[s] == own) among.push_back(s);
      }
      if (!among.empty()) owner = nearest_sphere(spheres_, among, triangle_centroid(mesh_, t));
    }
  }

  std::vector<std::uint32_t> of(int part) const {
    std::vector<std::uint32_t> out;
    for (std::uint32_t s = 0; s < of_sphere_.size(); ++s) {
      if (of_sphere_[s] == part) out.push_back(s);
    }
    return out;
  }

  // Triangles of a part, and those of them that other parts' spheres have.
  std::pair<std::size_t, std::size_t> count(int part) const {
    std::size_t all = 0, elsewhere = 0;
    for (std::size_t t = 0; t < part_of_.size(); ++t) {
      if (part_of_[t] != part) continue;
      ++all;
      elsewhere += of_sphere_[binding_.sphere_of_triangle[t]] == part ? 0 : 1;
    }
    return {all, elsewhere};
  }

 private:
  const Mesh& mesh_;
  const Regions& regions_;
  const Spheres& spheres_;
  Binding& binding_;
  std::vector<int> part_of_;    // of a triangle of the skin
  std::vector<int> of_sphere_;  // the part that most of a sphere's skin is of
};

}  // namespace

void ignore_parts(const Character& character, const Regions& regions, const Spheres& spheres, const BodyParts& parts,
                  const std::vector<std::array<std::string, 2>>& pairs, double gap, Binding& binding, EditsDone& done) {
  if (pairs.empty()) return;
  const auto index_of = [&](const std::string& name) {
    const auto found =
        std::find_if(parts.parts.begin(), parts.parts.end(), [&](const BodyPart& part) { return part.name == name; });
    return found == parts.parts.end() ? kNone : static_cast<int>(found - parts.parts.begin());
  };
  PartSpheres part_spheres(character, regions, spheres, parts, binding);
  std::set<int> named;
  for (const auto& pair : pairs) {
    const std::array<int, 2> two{index_of(pair[0]), index_of(pair[1])};
    if (two[0] != kNone && two[1] != kNone) named.insert(two.begin(), two.end());
  }
  for (const int part : named) part_spheres.separate(part);

  SpherePairs ignored(binding.ignored.begin(), binding.ignored.end());
  if (!named.empty()) add_neighbours(character.skin, binding.sphere_of_triangle, gap, ignored);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::string which = fmt::format("ignored_parts[{}]: {} and {}: ", i, pairs[i][0], pairs[i][1]);
    std::array<std::vector<std::uint32_t>, 2> of;
    std::string wrong;
    for (std::size_t k = 0; k < 2 && wrong.empty(); ++k) {
      const int part = index_of(pairs[i][k]);
      if (part == kNone) {
        wrong = fmt::format("there is no body part '{}'", pairs[i][k]);
        continue;
      }
      of[k] = part_spheres.of(part);
      const auto [all, elsewhere] = part_spheres.count(part);
      if (of[k].empty()) {
        wrong = fmt::format("the {} has no sphere of its own (add one)", pairs[i][k]);
      } else if (elsewhere > 0) {
        done.missed.push_back(which + fmt::format("ignored but for {} of the {} triangles of the {}, which are in "
                                                  "regions where it has no sphere of its own",
                                                  elsewhere, all, pairs[i][k]));
      }
    }
    if (!wrong.empty()) {
      done.missed.push_back(which + wrong);
      continue;
    }
    ++done.applied;
    for (const std::uint32_t a : of[0]) {
      for (const std::uint32_t b : of[1]) ignored.insert(std::minmax(a, b));
    }
  }
  binding.ignored.assign(ignored.begin(), ignored.end());
}

}  // namespace spherechain::baker
