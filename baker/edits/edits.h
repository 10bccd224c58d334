// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace spherechain::baker {

// A sphere's place in its region, and its size. Lengths are parts of the region's length, so that an edit means the
// same on a changed mesh.
struct SpherePlace {
  double along;                         // on the region's axis: 0 and 1 are its ends
  std::array<double, 2> across;         // from the axis
  double radius;                        // the fit radius
  std::optional<double> detect_radius;  // none: as the bake finds it

  bool operator==(const SpherePlace&) const = default;
};

// With both places a sphere is changed, with `from` alone deleted, with `to` alone added.
struct SphereEdit {
  std::string region;
  std::optional<SpherePlace> from, to;

  bool operator==(const SphereEdit&) const = default;
};

// Edits that `bake --edits` applies (docs/formats.md#edits).
struct Edits {
  std::vector<SphereEdit> spheres;
  std::vector<std::array<std::string, 2>> ignored_parts;

  bool empty() const { return spheres.empty() && ignored_parts.empty(); }
  bool operator==(const Edits&) const = default;
};

// Throws Error(kFile) that names `file` and the field where the text is no edits.
Edits parse_edits(const std::string& text, const std::string& file);

// The same as JSON.
std::string to_json(const Edits& edits);

}  // namespace spherechain::baker
