// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/edits/edit_spheres.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include "baker/edits/region_axes.h"

namespace spherechain::baker {
namespace {

using Ids = std::vector<std::uint32_t>;

constexpr std::size_t kSpheresMax = 500;  // as the setting `spheres` has it

constexpr double kFromSkin = 0.05;  // of the height: so far off the box of its region's skin a sphere may end

constexpr std::size_t kNamesMax = 16;  // of regions, in a line

constexpr std::size_t kNoEdit = ~std::size_t{0};

// The change to one fitted sphere, or the place at which a new sphere is inserted.
struct Change {
  std::size_t edit;
  bool deletes;
};
struct Added {
  std::size_t edit;
  FittedSphere sphere;
  std::uint32_t beside;  // a fitted sphere
  bool after;            // it, in the order of the chain; else before
};

// "spheres[2] changes the sphere of left_arm at 0.42: "
std::string name_of(const std::vector<SphereEdit>& edits, std::size_t edit) {
  const SphereEdit& of = edits[edit];
  const char* what = !of.from ? "adds a sphere" : of.to ? "changes the sphere" : "deletes the sphere";
  return fmt::format("spheres[{}] {} of {} at {:.2f}: ", edit, what, of.region,
                     of.from ? of.from->along : of.to->along);
}

class SphereEditor {
 public:
  SphereEditor(const Character& character, const Regions& regions, const Spheres& spheres,
               const std::vector<SphereEdit>& edits, EditsDone& done)
      : character_(character), regions_(regions), old_(spheres), edits_(edits), done_(done) {
    axes_ = region_axes(regions.frame, character.skin, regions.of_skin, regions.count());
    for (std::size_t e = 0; e < edits.size(); ++e) {
      region_of_.push_back(find_region(edits[e].region));
      if (!region_of_[e]) miss(e, fmt::format("there is no region '{}', only {}", edits[e].region, region_names()));
      if (region_of_[e]) drop_if_far(e);
    }
  }

  void find() {
    find_addressed();
    drop_last_deletes();
    for (std::size_t e = 0; e < edits_.size(); ++e) {
      if (region_of_[e] && !edits_[e].from) add(e);
    }
  }

  void insert(const FittedSphere& sphere, std::size_t edit = kNoEdit) {
    const std::uint32_t nearest = nearest_sphere(old_, old_.of_region[sphere.region], sphere.ball.center);
    // The spheres of a level of the torso stand from left to right.
    const Vec3 onwards = sphere.level >= 0 && !sphere.extremity ? Vec3(-regions_.frame.left) : sphere.axis;
    const bool after = onwards.dot(sphere.ball.center - old_.spheres[nearest].ball.center) >= 0;
    added_.push_back({edit, sphere, nearest, after});
  }

  // A sphere of the kind that the nearest is.
  FittedSphere beside(std::uint8_t region, const Ball& ball) const {
    FittedSphere out = old_.spheres[nearest_sphere(old_, old_.of_region[region], ball.center)];
    out.ball = ball;
    out.detect_radius.reset();
    out.body_part = -1;
    return out;
  }

  Spheres result(std::vector<AppliedEdit>& applied) const {
    Spheres out;
    out.level_heights = old_.level_heights;
    out.of_region.resize(old_.of_region.size());
    std::vector<std::optional<std::uint32_t>> place(old_.spheres.size());
    const auto put = [&](const FittedSphere& sphere) {
      out.of_region[sphere.region].push_back(static_cast<std::uint32_t>(out.spheres.size()));
      out.spheres.push_back(sphere);
      return static_cast<std::uint32_t>(out.spheres.size() - 1);
    };
    const auto put_added = [&](std::uint32_t beside, bool after) {
      for (const Added& added : added_) {
        if (added.beside != beside || added.after != after) continue;
        const std::uint32_t sphere = put(added.sphere);
        if (added.edit != kNoEdit) applied.push_back({added.edit, sphere});
      }
    };
    for (std::uint32_t s = 0; s < old_.spheres.size(); ++s) {
      put_added(s, false);
      const auto change = changes_.find(s);
      if (change == changes_.end()) {
        place[s] = put(old_.spheres[s]);
      } else if (!change->second.deletes) {
        place[s] = put(placed(old_.spheres[s], change->second.edit));
        applied.push_back({change->second.edit, *place[s]});
      }
      put_added(s, true);
    }
    for (const TorsoFit& fit : old_.torso) {
      if (!place[fit.sphere] || changes_.count(fit.sphere) > 0) continue;
      out.torso.push_back(fit);
      out.torso.back().sphere = *place[fit.sphere];
    }
    share_skin(place, out);
    link(place, out);
    return out;
  }

 private:
  void miss(std::size_t edit, const std::string& why) const { done_.missed.push_back(name_of(edits_, edit) + why); }

  std::optional<std::uint8_t> find_region(const std::string& name) const {
    for (std::size_t r = 0; r < regions_.count(); ++r) {
      if (regions_.name(r) == name) return static_cast<std::uint8_t>(r);
    }
    return std::nullopt;
  }

  std::string region_names() const {
    std::string out;
    for (std::size_t r = 0; r < regions_.count(); ++r) {
      if (r == kNamesMax) return out + " ...";
      out += (r == 0 ? "" : ", ") + regions_.name(r);
    }
    return out;
  }

  // An edit that would put its sphere where no skin of its region can carry it is none.
  void drop_if_far(std::size_t edit) {
    const std::optional<SpherePlace>& to = edits_[edit].to;
    if (!to) return;
    const Vec3 center = axes(edit).point(*to);
    Eigen::AlignedBox3d box;
    for (Index t = 0; t < regions_.of_skin.size(); ++t) {
      if (regions_.of_skin[t] != *region_of_[edit]) continue;
      for (const Index v : character_.skin.triangles[t]) box.extend(character_.skin.positions[v]);
    }
    const double from_skin = box.exteriorDistance(center) - to->radius * axes(edit).length;
    if (from_skin <= kFromSkin * regions_.frame.height) return;
    miss(edit, fmt::format("it would end {:.1f} % of the height away from the region's skin",
                           100 * from_skin / regions_.frame.height));
    region_of_[edit].reset();
  }

  const RegionAxes& axes(std::size_t edit) const { return axes_[*region_of_[edit]]; }

  // The nearest pairs of an edit and a sphere first.
  void find_addressed() {
    std::vector<std::tuple<double, std::size_t, std::uint32_t>> near;
    std::vector<double> nearest(edits_.size(), std::numeric_limits<double>::max());
    std::vector<bool> found(edits_.size(), false);
    for (std::size_t e = 0; e < edits_.size(); ++e) {
      if (!region_of_[e] || !edits_[e].from) continue;
      const Vec3 from = axes(e).point(*edits_[e].from);
      for (const std::uint32_t s : old_.of_region[*region_of_[e]]) {
        const Ball& ball = old_.spheres[s].ball;
        const double distance = (ball.center - from).norm();
        nearest[e] = std::min(nearest[e], distance);
        if (distance <= ball.radius) near.emplace_back(distance, e, s);
      }
    }
    std::sort(near.begin(), near.end());
    for (const auto& [distance, e, s] : near) {
      if (found[e] || changes_.count(s) > 0) continue;
      changes_[s] = {e, !edits_[e].to};
      found[e] = true;
    }
    for (std::size_t e = 0; e < edits_.size(); ++e) {
      if (!region_of_[e] || !edits_[e].from || found[e]) continue;
      const bool is_taken =
          std::any_of(near.begin(), near.end(), [&](const auto& one) { return std::get<1>(one) == e; });
      miss(e, is_taken ? "another edit is about the sphere that is there"
                       : fmt::format("there is no sphere (the nearest is {:.1f} % of the height away)",
                                     100 * nearest[e] / regions_.frame.height));
    }
  }

  // A region's skin needs a sphere.
  void drop_last_deletes() {
    for (std::uint8_t region = 0; region < old_.of_region.size(); ++region) {
      const Ids& ids = old_.of_region[region];
      const auto is_deleted = [&](std::uint32_t s) { return changes_.count(s) > 0 && changes_.at(s).deletes; };
      if (ids.empty() || !std::all_of(ids.begin(), ids.end(), is_deleted)) continue;
      const auto last = std::max_element(ids.begin(), ids.end(), [&](std::uint32_t a, std::uint32_t b) {
        return changes_.at(a).edit < changes_.at(b).edit;
      });
      miss(changes_.at(*last).edit, "it is the last sphere of its region, which needs one");
      changes_.erase(*last);
    }
  }

  FittedSphere placed(FittedSphere sphere, std::size_t edit) const {
    const SpherePlace& to = *edits_[edit].to;
    const double length = axes(edit).length;
    sphere.ball = {axes(edit).point(to), to.radius * length};
    if (to.detect_radius) sphere.detect_radius = *to.detect_radius * length;
    return sphere;
  }

  void add(std::size_t edit) {
    const std::uint8_t region = *region_of_[edit];
    const auto of_region =
        static_cast<std::size_t>(std::count(regions_.of_skin.begin(), regions_.of_skin.end(), region));
    const auto added = static_cast<std::size_t>(
        std::count_if(added_.begin(), added_.end(), [&](const Added& other) { return other.sphere.region == region; }));
    if (old_.spheres.size() + added_.size() >= kSpheresMax) {
      return miss(edit, fmt::format("{} spheres are the most that a character has", kSpheresMax));
    }
    if (old_.of_region[region].size() + added >= of_region) {
      return miss(edit, "the region has no more triangles than spheres");
    }
    const Vec3 point = axes(edit).point(*edits_[edit].to);
    insert(placed(beside(region, {point, 0}), edit), edit);
  }

  // The owner of each triangle of a tree: anew in the regions that edits are about.
  void share_skin(const std::vector<std::optional<std::uint32_t>>& place, Spheres& out) const {
    if (old_.of_skin.empty()) return;
    std::vector<std::vector<Index>> edited(old_.of_region.size());
    std::vector<bool> is_edited(old_.of_region.size(), false);
    for (const auto& [sphere, change] : changes_) is_edited[old_.spheres[sphere].region] = true;
    for (const Added& added : added_) is_edited[added.sphere.region] = true;
    out.of_skin.resize(old_.of_skin.size());
    for (Index t = 0; t < out.of_skin.size(); ++t) {
      const std::uint8_t region = regions_.of_skin[t];
      if (!is_edited[region]) {
        out.of_skin[t] = *place[old_.of_skin[t]];
      } else if (regions_.is_by_bones(region)) {
        edited[region].push_back(t);
      } else {
        out.of_skin[t] = nearest_sphere(out, out.of_region[region], triangle_centroid(character_.skin, t));
      }
    }
    for (std::size_t region = 0; region < edited.size(); ++region) {
      if (edited[region].empty()) continue;
      std::vector<Ball> balls;
      for (const std::uint32_t s : out.of_region[region]) balls.push_back(out.spheres[s].ball);
      const std::vector<std::size_t> owners = share_triangles(character_.skin, regions_.frame, edited[region], balls);
      for (std::size_t k = 0; k < owners.size(); ++k) {
        out.of_skin[edited[region][k]] = out.of_region[region][owners[k]];
      }
    }
  }

  void link(const std::vector<std::optional<std::uint32_t>>& place, Spheres& out) const {
    if (!regions_.is_tree()) {
      out.links = find_links(out, regions_);
      return;
    }
    out.links = find_links(character_, regions_, out);
    for (const auto& [a, b] : old_.links) {
      if (place[a] && place[b]) out.links.push_back(std::minmax(*place[a], *place[b]));
    }
    for (std::size_t region = 0; region < out.of_region.size(); ++region) {
      if (regions_.is_by_bones(region)) continue;
      const Ids& ids = out.of_region[region];
      for (std::size_t i = 1; i < ids.size(); ++i) out.links.emplace_back(ids[i - 1], ids[i]);
    }
    std::sort(out.links.begin(), out.links.end());
    out.links.erase(std::unique(out.links.begin(), out.links.end()), out.links.end());
  }

  const Character& character_;
  const Regions& regions_;
  const Spheres& old_;
  const std::vector<SphereEdit>& edits_;
  EditsDone& done_;
  std::vector<std::optional<std::uint8_t>> region_of_;  // of each edit
  std::vector<RegionAxes> axes_;                        // of each region
  std::map<std::uint32_t, Change> changes_;             // of fitted spheres
  std::vector<Added> added_;
};

}  // namespace

Spheres edit_spheres(const Character& character, const Regions& regions, const Spheres& spheres,
                     const std::vector<SphereEdit>& edits, EditsDone& done, std::vector<AppliedEdit>& applied) {
  const std::size_t missed = done.missed.size();
  SphereEditor editor(character, regions, spheres, edits, done);
  editor.find();
  done.applied += edits.size() - (done.missed.size() - missed);
  return editor.result(applied);
}

Spheres insert_spheres(const Character& character, const Regions& regions, const Spheres& spheres,
                       const std::vector<PartSphere>& added) {
  EditsDone done;
  std::vector<AppliedEdit> applied;
  const std::vector<SphereEdit> none;
  SphereEditor editor(character, regions, spheres, none, done);
  for (const PartSphere& one : added) {
    FittedSphere sphere = editor.beside(one.region, one.ball);
    sphere.body_part = one.part;
    editor.insert(sphere);
  }
  return editor.result(applied);
}

void check_places(const Regions& regions, const Spheres& spheres, const Binding& binding,
                  const std::vector<SphereEdit>& edits, const std::vector<AppliedEdit>& applied, EditsDone& done) {
  constexpr double kOff = 0.002;  // of the height
  for (const AppliedEdit& one : applied) {
    const Vec3& asked = spheres.spheres[one.sphere].ball.center;
    const double off = (binding.spheres[one.sphere].rest.center - asked).norm() / regions.frame.height;
    if (off <= kOff) continue;
    done.missed.push_back(name_of(edits, one.edit) +
                          fmt::format("no skin carries it there; it stands {:.1f} % of the height away", 100 * off));
  }
}

}  // namespace spherechain::baker
