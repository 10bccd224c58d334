// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "baker/bind/body_parts.h"
#include "baker/play/play.h"
#include "spherechain/contacts.h"

namespace spherechain::baker {

// Triangle pairs that intersect, counted by the two body parts they belong to: indices of BodyParts::parts, a <= b.
using PartCounts = std::map<std::pair<std::size_t, std::size_t>, std::size_t>;

// Which body parts' skins touch, clip by clip, in the clip's own frames.
class PartContacts {
 public:
  // `animated` must outlive it.
  explicit PartContacts(const AnimatedAsset& animated)
      : animated_(animated), mm_(mm_per_unit(animated.asset())), parts_(body_parts_of(animated.asset())) {}

  // Frames are added in order. Returns the frame's counts.
  PartCounts add(int frame, const std::vector<Pair>& triangles, const std::vector<Penetration>& penetrations);

  const std::string& name(std::size_t part) const { return parts_.parts[part].name; }
  const BodyParts& parts() const { return parts_; }

  // The frames so far, a paragraph for each clip: faults and deep folds, the deepest first, and how many contacts of
  // other classes there are. The part that is named first goes out along the direction. `motion` names what is not made
  // of clips.
  std::string text(const std::string& motion) const;
  // The same as a list of clips.
  nlohmann::ordered_json json() const;

 private:
  // Two body parts in one clip.
  struct Contact {
    std::pair<std::size_t, std::size_t> parts;  // the first goes into the second
    // Numbers of the first and the last frame of each run; of all, and of those that are faults.
    std::vector<std::pair<double, double>> runs, fault_runs;
    std::size_t triangle_pairs_max = 0;
    double frame_of_max = 0;
    double depth_mm_max = 0;  // of the deepest fault, or without one of the deepest; its frame, and what is there
    double frame_of_depth_max = 0;
    spherechain::Vec3 direction{};
    PenetrationClass kind = SC_CLASS_REST;
    double swallowed = 0;
    bool passes_through = false;
  };
  using Contacts = std::map<std::pair<std::size_t, std::size_t>, Contact>;
  struct Clip {
    Contacts contacts;
    int contact_frames = 0, fault_frames = 0;
  };
  using Row = Contacts::const_pointer;

  std::size_t part_of(std::uint32_t triangle) const;
  std::string head(std::size_t clip, const std::string& motion) const;
  std::string rows(const Clip& clip) const;

  const AnimatedAsset& animated_;
  double mm_;  // a unit of the source, in millimetres
  BodyParts parts_;
  std::vector<Clip> clips_;
  int last_frame_ = -1;
};

}  // namespace spherechain::baker
