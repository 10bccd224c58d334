// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/page/shrink_picture.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "baker/import/read_in_child.h"
#include "baker/page/base64.h"

// The library is C of another style: its warnings are not ours to mend.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wduplicated-branches"
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_HDR
#define STBI_NO_PIC
#define STBI_NO_PNM
#define STBI_NO_STDIO
#include <stb/stb_image.h>
#define STB_IMAGE_RESIZE_STATIC
#define STB_IMAGE_RESIZE_IMPLEMENTATION
#include <stb/stb_image_resize.h>
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace spherechain::baker {
namespace {

constexpr std::int64_t kPixelsMax = std::int64_t{1} << 26;
constexpr int kJpegQuality = 85;

void append(void* out, void* data, int size) {
  static_cast<std::string*>(out)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

std::string data_url(const std::string& type, const std::string& bytes) {
  return "data:image/" + type + ";base64," + base64(std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
}

std::string shrink(const std::string& bytes, int size_max, bool keeps_alpha) {
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size()), channels = keeps_alpha ? 4 : 3;
  int width = 0, height = 0, own = 0;
  if (stbi_info_from_memory(data, size, &width, &height, &own) == 0 || width < 1 || height < 1 ||
      std::int64_t{width} * height > kPixelsMax) {
    return {};
  }
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(data, size, &width, &height, &own, channels), stbi_image_free);
  if (pixels == nullptr) return {};
  const double scale = std::min(1.0, static_cast<double>(size_max) / std::max(width, height));
  const int w = std::max(1, static_cast<int>(scale * width)), h = std::max(1, static_cast<int>(scale * height));
  std::vector<stbi_uc> small(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) *
                             static_cast<std::size_t>(channels));
  if (stbir_resize_uint8_srgb(pixels.get(), width, height, 0, small.data(), w, h, 0, channels,
                              keeps_alpha ? 3 : STBIR_ALPHA_CHANNEL_NONE, 0) == 0) {
    return {};
  }
  std::string png, jpeg;
  stbi_write_png_to_func(append, &png, w, h, channels, small.data(), w * channels);
  if (!keeps_alpha) stbi_write_jpg_to_func(append, &jpeg, w, h, channels, small.data(), kJpegQuality);
  return jpeg.empty() || png.size() <= jpeg.size() ? data_url("png", png) : data_url("jpeg", jpeg);
}

}  // namespace

std::string shrink_picture(const std::string& bytes, int size_max, bool keeps_alpha) {
  if (bytes.empty() || bytes.size() > std::size_t{1} << 30) return {};
  try {
    return read_in_child("a picture", [&] { return shrink(bytes, size_max, keeps_alpha); });
  } catch (const std::exception&) {
    return {};
  }
}

}  // namespace spherechain::baker
