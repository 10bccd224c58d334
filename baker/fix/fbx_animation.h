// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "baker/import/fbx_file.h"
#include "baker/import/source_rig.h"

namespace spherechain::baker {

// The stack of an FBX file that a clip was read from.
class FbxAnimation {
 public:
  // `fbx` and `file` must outlive it. Throws Error(kFile) that begins with `file` if the clip is not in the file, or
  // several layers turn a joint: assimp does not add them up.
  FbxAnimation(const FbxFile& fbx, const std::string& file, const Clip& clip);

  // A curve node and its curves for x, y and z; null where there is none yet.
  struct Track {
    const FbxObject* layer = nullptr;
    const FbxObject* node = nullptr;
    std::array<const FbxObject*, 3> curves{};

    bool has_curves() const { return curves[0] != nullptr || curves[1] != nullptr || curves[2] != nullptr; }
  };
  // The curves of a model's property, such as "Lcl Rotation", or the place where some can be added: the base layer.
  // Throws Error(kFile) if several layers have some, or another model or animation shares them.
  Track track_of(const FbxObject& model, const std::string& property) const;

  // Null if there is none.
  const FbxObject* object(std::int64_t id) const;
  // The clip's time 0 on the file's time line. Throws Error(kFile) if the clip has no keys of the file.
  std::int64_t start_of(const SourceRig& rig, const Clip& clip) const;

 private:
  Track track(const FbxObject& layer, std::int64_t node) const;
  // In each layer that has a curve node for it.
  std::vector<Track> tracks(const FbxObject& model, const std::string& property) const;
  void check_layers(const FbxObject& model, const std::vector<Track>& tracks) const;

  const FbxFile& fbx_;
  const std::string& file_;
  std::map<std::int64_t, const FbxObject*> objects_;
  std::multimap<std::int64_t, const FbxLink*> by_parent_, by_child_;
  std::set<std::pair<std::int64_t, std::int64_t>> child_and_parent_;
  const FbxObject* stack_ = nullptr;
  std::vector<const FbxObject*> layers_;
};

}  // namespace spherechain::baker
