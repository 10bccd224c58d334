// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "baker/check/library.h"
#include "baker/check/results.h"
#include "baker/check/store.h"
#include "baker/import/source_rig.h"

namespace spherechain::baker {

// A unit of a character is the clips in its own file, or one recording: its motions[unit - 1].
inline constexpr std::size_t kOwnClips = 0, kClipsPerUnitMax = 100000;

// One clip of a library, and where its results are. Or a character that has none.
struct CheckedClip {
  std::size_t character = 0;       // its place in the library
  std::size_t order = 0;           // of the clip among the character's: unit * kClipsPerUnitMax + number in it
  std::string clip;                // name; empty: of a character that has none
  std::string error;               // why it could not be checked: "FILE: what (what to do)"
  std::string key, character_key;  // in the store: of the clip, of the character
  bool was_interrupted = false;    // the error does not come from the library (Interrupted)
};

// Part `index` of `count`, from 1, of a library: runs of characters and recordings of about the same size.
struct Shard {
  int index = 1, count = 1;
};

struct RunOptions {
  double fps = 0;           // 0: each clip's own
  bool continuous = false;  // look between frames, too
  int jobs = 1;
  Shard shard;
};

// Names that a check gives to the clips of a character's file.
std::vector<std::string> unique_clip_names(const SourceRig& rig);

// The state of a run.
struct RunState {
  const char* doing;  // "baking", "checking"
  std::size_t done, all;
  std::string now = {};  // the latest news of one of those in work: "hero.glb: wrap"
};

// Brings the results of all clips into `store`: what it has is kept, characters are baked where they must be. Whatever
// a file does, the others are checked. Returns the clips in the library's order. Throws Error(kFile) where the store
// cannot be written.
std::vector<CheckedClip> check_library(const std::vector<LibraryCharacter>& library, const RunOptions& options,
                                       const Store& store, const std::function<void(const RunState&)>& progress);

// Kinds of files in the store. A character has its asset, its CharacterResult and its page; a clip has its ClipResult,
// its page, its pictures (picture_file) and its HeatSpots.
inline constexpr const char *kAssetFile = ".sphc", *kResultFile = ".json", *kPageFile = ".js", *kPictureFile = ".png",
                            *kHeatFile = ".heat";
// The name of a clip's picture of that number: 0 is kPictureFile.
std::string picture_file(std::size_t number);
// Kinds of all files of a clip with that result.
std::vector<std::string> files_of(const ClipResult& result);

}  // namespace spherechain::baker
