// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/edits/ignore_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "baker/bind/neighbours.h"
#include "baker/fit/piece.h"

namespace spherechain::baker {
namespace {

constexpr int kNone = -1;

int index_of(const BodyParts& parts, const std::string& name) {
  const auto found =
      std::find_if(parts.parts.begin(), parts.parts.end(), [&](const BodyPart& part) { return part.name == name; });
  return found == parts.parts.end() ? kNone : static_cast<int>(found - parts.parts.begin());
}

// The parts of pairs whose two parts are there.
std::set<int> named_parts(const BodyParts& parts, const PartPairs& pairs) {
  std::set<int> out;
  for (const auto& [first, second] : pairs) {
    const int a = index_of(parts, first), b = index_of(parts, second);
    if (a != kNone && b != kNone) out.insert({a, b});
  }
  return out;
}

// Which part each sphere is of: the one it was made for, or that of most of its skin.
class PartSpheres {
 public:
  PartSpheres(const Character& character, const Regions& regions, const Spheres& spheres, const BodyParts& parts,
              std::vector<std::uint32_t>& owner)
      : mesh_(character.skin), regions_(regions), spheres_(spheres), owner_(owner) {
    for (const Index source : character.skin_source_triangle) part_of_.push_back(parts.of_triangle[source]);
    give_back();
    std::vector<std::vector<double>> areas(spheres.spheres.size(), std::vector<double>(parts.parts.size(), 0.0));
    for (std::size_t t = 0; t < part_of_.size(); ++t) {
      areas[owner[t]][static_cast<std::size_t>(part_of_[t])] += triangle_area(mesh_, t);
    }
    for (std::size_t s = 0; s < areas.size(); ++s) {
      const auto most = std::max_element(areas[s].begin(), areas[s].end());
      const int of_skin = most == areas[s].end() || *most <= 0 ? kNone : static_cast<int>(most - areas[s].begin());
      of_sphere_.push_back(spheres.spheres[s].body_part != kNone ? spheres.spheres[s].body_part : of_skin);
    }
  }

  std::vector<std::uint32_t> of(int part) const {
    std::vector<std::uint32_t> out;
    for (std::uint32_t s = 0; s < of_sphere_.size(); ++s) {
      if (of_sphere_[s] == part) out.push_back(s);
    }
    return out;
  }
  std::vector<std::uint32_t> of(int part, std::uint8_t region) const {
    std::vector<std::uint32_t> out;
    for (const std::uint32_t s : spheres_.of_region[region]) {
      if (of_sphere_[s] == part) out.push_back(s);
    }
    return out;
  }

  // Regions and parts without a sphere of the part there: of its triangles some are a named part's, or in its spheres.
  std::set<std::pair<std::uint8_t, int>> lacking(const std::set<int>& named) const {
    std::set<std::pair<std::uint8_t, int>> out;
    for (std::size_t t = 0; t < part_of_.size(); ++t) {
      const std::uint8_t region = regions_.of_skin[t];
      if (named.count(part_of_[t]) == 0 && named.count(of_sphere_[owner_[t]]) == 0) continue;
      if (of(part_of_[t], region).empty()) out.insert({region, part_of_[t]});
    }
    return out;
  }

  // A part's triangles in a region.
  std::vector<Index> triangles(int part, std::uint8_t region) const {
    std::vector<Index> out;
    for (Index t = 0; t < part_of_.size(); ++t) {
      if (part_of_[t] == part && regions_.of_skin[t] == region) out.push_back(t);
    }
    return out;
  }

  // Gives the triangles of a part to its spheres, and takes from them those of others.
  void separate(int part) {
    for (std::size_t t = 0; t < part_of_.size(); ++t) {
      const int own = part_of_[t];
      const int holder = of_sphere_[owner_[t]];
      if (holder == own || (own != part && holder != part)) continue;
      const std::vector<std::uint32_t> among = of(own, regions_.of_skin[t]);
      if (!among.empty()) owner_[t] = nearest_sphere(spheres_, among, triangle_centroid(mesh_, t));
    }
  }

  // How many triangles of a part other parts' spheres have, or of others its spheres.
  std::size_t misplaced(int part) const {
    std::size_t count = 0;
    for (std::size_t t = 0; t < part_of_.size(); ++t) {
      count += (part_of_[t] == part) != (of_sphere_[owner_[t]] == part) ? 1 : 0;
    }
    return count;
  }

 private:
  // A sphere that was made for a part has no triangles of others. So the parts of all others are what they were.
  void give_back() {
    for (std::size_t t = 0; t < part_of_.size(); ++t) {
      const auto may_own = [&](std::uint32_t s) {
        const int part = spheres_.spheres[s].body_part;
        return part == kNone || part == part_of_[t];
      };
      if (may_own(owner_[t])) continue;
      std::vector<std::uint32_t> among = spheres_.of_region[regions_.of_skin[t]];
      among.erase(std::remove_if(among.begin(), among.end(), [&](auto s) { return !may_own(s); }), among.end());
      if (!among.empty()) owner_[t] = nearest_sphere(spheres_, among, triangle_centroid(mesh_, t));
    }
  }

  const Mesh& mesh_;
  const Regions& regions_;
  const Spheres& spheres_;
  std::vector<std::uint32_t>& owner_;  // of each triangle of the skin
  std::vector<int> part_of_;           // likewise
  std::vector<int> of_sphere_;
};

}  // namespace

Spheres add_part_spheres(const Character& character, const Regions& regions, const Spheres& spheres,
                         const BodyParts& parts, const PartPairs& pairs) {
  const std::set<int> named = named_parts(parts, pairs);
  if (named.empty()) return spheres;
  std::vector<std::uint32_t> owner = assign_triangles(character.skin, regions, spheres);
  const PartSpheres part_spheres(character, regions, spheres, parts, owner);
  std::optional<PieceFitter> fitter;
  std::vector<PartSphere> added;
  for (const auto& [region, part] : part_spheres.lacking(named)) {
    if (!fitter) fitter.emplace(character.skin, kWellFitted * regions.frame.height);
    added.push_back({region, part, fitter->fit(fitter->samples_of(part_spheres.triangles(part, region))).ball});
  }
  return added.empty() ? spheres : insert_spheres(character, regions, spheres, added);
}

void ignore_parts(const Character& character, const Regions& regions, const Spheres& spheres, const BodyParts& parts,
                  const PartPairs& pairs, double gap, Binding& binding, EditsDone& done) {
  if (pairs.empty()) return;
  PartSpheres part_spheres(character, regions, spheres, parts, binding.sphere_of_triangle);
  const std::set<int> named = named_parts(parts, pairs);
  for (const int part : named) part_spheres.separate(part);
  SpherePairs ignored(binding.ignored.begin(), binding.ignored.end());
  if (!named.empty()) add_neighbours(character.skin, binding.sphere_of_triangle, gap, ignored);

  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto miss = [&](const std::string& why) {
      done.missed.push_back(fmt::format("ignored_parts[{}]: {} and {}: {}", i, pairs[i][0], pairs[i][1], why));
    };
    const int first = index_of(parts, pairs[i][0]), second = index_of(parts, pairs[i][1]);
    if (first == kNone || second == kNone) {
      miss(fmt::format("there is no body part '{}'", pairs[i][first == kNone ? 0 : 1]));
      continue;
    }
    ++done.applied;
    for (const std::uint32_t a : part_spheres.of(first)) {
      for (const std::uint32_t b : part_spheres.of(second)) ignored.insert(std::minmax(a, b));
    }
    if (const std::size_t left = part_spheres.misplaced(first) + part_spheres.misplaced(second); left > 0) {
      miss(fmt::format("ignored but for {} triangles at their borders: an edit took the sphere that they need", left));
    }
  }
  binding.ignored.assign(ignored.begin(), ignored.end());
}

}  // namespace spherechain::baker
