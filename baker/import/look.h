// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace spherechain::baker {

// Colour that a material gives to the skin. Colours are sRGB from 0 to 1.
struct SkinMaterial {
  std::array<float, 3> colour{1, 1, 1};  // where there is no picture
  std::array<float, 3> tint{1, 1, 1};    // of the picture
  std::int32_t picture = -1;             // into SourceLook::pictures; -1: none
  float cut = 0;                         // below this alpha the picture shows nothing; 0: all of it is shown
};

inline constexpr std::uint16_t kNoMaterial = 0xFFFF;

// How a source's skin is coloured: its base colours. Nothing of it is needed for a bake, and nothing that is wrong with
// it stops one.
struct SourceLook {
  std::vector<std::array<float, 2>> uvs;   // of every source vertex; (0, 0) is the picture's upper left
  std::vector<std::uint16_t> material_of;  // of every source triangle
  std::vector<SkinMaterial> materials;
  std::vector<std::string> pictures;  // PNG, JPEG and others, as the file has them; empty where one is not there

  // Returns its number. It stays empty where all of them are too large for a character.
  std::int32_t add_picture(std::string bytes);
};

inline constexpr std::uintmax_t kPictureBytesMax = std::uintmax_t{1} << 26;  // of one; all may have four times as many

// A picture's bytes; none where it is no file, or too large.
std::string read_picture(const std::filesystem::path& file);

// By its first bytes: "image/png", "image/jpeg", "image/webp" or "image/ktx2"; empty for others.
std::string type_of_picture(std::string_view bytes);

// A picture of another type (TGA, BMP, PSD, GIF) as a PNG; empty where it cannot be read. For a child process
// (read_in_child.h).
std::string png_of_picture(const std::string& bytes);

}  // namespace spherechain::baker
