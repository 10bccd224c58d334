// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "baker/bind/bind.h"
#include "baker/bind/bind_bones.h"
#include "baker/bind/bind_moments.h"
#include "baker/bind/body_parts.h"
#include "baker/bind/fit_quality.h"
#include "baker/chains/chains.h"
#include "baker/clusters/clusters.h"
#include "baker/edits/edit_spheres.h"
#include "baker/edits/edits.h"
#include "baker/fit/fit.h"
#include "baker/import/import.h"
#include "baker/import/size.h"
#include "baker/layers/layers.h"
#include "baker/mesh/attempt.h"
#include "baker/rig/rig.h"
#include "baker/roles/roles.h"
#include "baker/segment/segment.h"
#include "baker/wrap/closing_report.h"

namespace spherechain::baker {

// Targets of a bake. If one is missed, the asset is still written and the exit code says so.
struct Targets {
  std::optional<FitGrade> fit;  // or better
};

// Limits of the setting `spheres`, and what it is for a prop.
inline constexpr int kSpheresMin = 8, kSpheresMax = 500, kPropSpheres = 32;

struct BakeSettings {
  ImportOptions import;
  GivenSize size;
  RoleFile roles;
  SegmentSettings segment;
  FitSettings fit;
  BindSettings bind;
  ClusterSettings clusters;
  Targets targets;
  Edits edits;
};

// "paper" (the paper's refit on 4 pivots, no spheres in head, hands and feet), "balanced" (refit by moments,
// extremities) or "prop" (a rigid thing: few spheres, which hold all of it), changed by a JSON text. Throws
// Error(kFile) that names `file` where the JSON is broken, has an unknown key, a value out of its range or one that no
// prop has; Error(kUsage) for another profile.
BakeSettings make_settings(const std::string& profile, const std::string& json, const std::string& file);

// Throws Error(kFile) where a bake with these settings cannot keep to its edits: of a prop, or by the paper's refit.
// `what` is what the message calls them.
void check_edits(const BakeSettings& settings, const std::string& what);

// "biped" or "quadruped"; "auto" is unknown: found.
BodyKind parse_body(const std::string& name);

// The settings as canonical JSON: all keys, sorted, no spaces. `prop`, `scale`, `height` and `edits` only where
// there are such.
std::string to_json(const BakeSettings& settings);

struct StageTime {
  std::string stage;
  double seconds;
};

// All stages' results, import to write.
struct Bake {
  BakeSettings settings;
  Character character;
  Roles roles;  // of the nodes of character.rig
  Regions regions;
  ClosingReport closing;
  Choice segmented_by;
  Spheres spheres;
  Chains chains;
  Binding binding;
  std::vector<Joint> joints;
  std::vector<VertexWeights> rig_weights;  // to the joints, of every source vertex; none where the source has bones
  BodyParts body_parts;
  FitQuality quality;
  EditsDone edits_done;  // results of settings.edits
  BoneBinding bones;
  MomentBinding moments;
  Clusters clusters;
  Layers layers;
  std::vector<std::uint8_t> asset;
  std::vector<StageTime> times;
};

// The result of the stages segment and wrap.
struct Segmentation {
  Regions regions;
  ClosingReport closing;
  Choice choice;
};

// Characters whose skin may be wrapped. Wrapping is slow; where bones move the skin, the fit by bones replaces it.
enum class Wraps : std::uint8_t { kUnmoved, kAll };

// Tries the strategies of segmentation in order: by shape, by rig, and both on a closed surface made of the skin.
Attempt<Segmentation> segment_character(const Character& character, const Roles& roles, const SegmentSettings& settings,
                                        Wraps wraps);

// A character's regions, their spheres and pivots.
struct FittedCharacter {
  Segmentation segmentation;
  Spheres spheres;
  Binding binding;
  FitQuality quality;
};

// The paper's fit on what segment_character finds. Where there is none, it is not good, or the settings limit the
// spheres, also the fit by halves of the bones' parts: the one with less skin far from its sphere is taken. Under the
// paper's refit rule, and where the settings name a body, there is only the first; of a prop only the second. Throws
// Error(kSegmentation) where there is none.
FittedCharacter fit_character(const Character& character, const Roles& roles, const BakeSettings& settings);

// Runs every stage. `progress` gets each stage's name before it runs; it may be empty.
Bake bake(const std::filesystem::path& input, const BakeSettings& settings,
          const std::function<void(const std::string&)>& progress);

// The stages after segmentation again, on the same character and regions, with other settings for them. Where those of
// the fit are the same, the spheres stay. Neither bake has edits.
Bake rebake(const Bake& bake, const BakeSettings& settings);

// Targets that the settings ask for and the bake missed, a sentence each.
std::vector<std::string> missed_targets(const Bake& bake);

}  // namespace spherechain::baker
