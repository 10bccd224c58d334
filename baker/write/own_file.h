// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace spherechain::baker {

// A kind of file that commands write.
enum class FileKind { kAsset, kJson, kSarif, kJunit, kPage, kGlb, kBvh, kFbx, kColliders, kPalettes, kTable };

// "an asset", "a page".
const char* kind_text(FileKind kind);

// True if writing to `file` destroys no foreign data: it is not there, is empty, is written directly (a device), or
// holds the mark of this tool as it writes it into files of this kind, or has the bytes of `copy_of`. BVH, FBX
// and CSV files have no mark.
bool is_own_file(const std::filesystem::path& file, FileKind kind, const std::filesystem::path& copy_of = {});

// The key in a glTF's asset.extras that marks it. Its value is the tool's version.
inline constexpr const char* kGltfMark = "spherechain";

}  // namespace spherechain::baker
