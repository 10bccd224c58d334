// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>
#include <memory>

#include "baker/import/look.h"

// The library is C of another style: its warnings are not ours to mend.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wduplicated-branches"
#endif
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_HDR
#define STBI_NO_STDIO
#include <stb/stb_image.h>
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace spherechain::baker {

std::string png_of_picture(const std::string& bytes) {
  constexpr std::int64_t kPixelsMax = std::int64_t{1} << 26;
  if (bytes.empty() || bytes.size() > kPictureBytesMax) return {};
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(data, size, &width, &height, &channels) == 0 || width < 1 || height < 1 ||
      std::int64_t{width} * height > kPixelsMax) {
    return {};
  }
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(data, size, &width, &height, &channels, 0), stbi_image_free);
  std::string png;
  const auto append = [](void* out, void* part, int length) {
    static_cast<std::string*>(out)->append(static_cast<const char*>(part), static_cast<std::size_t>(length));
  };
  if (pixels != nullptr) stbi_write_png_to_func(append, &png, width, height, channels, pixels.get(), width * channels);
  return png;
}

}  // namespace spherechain::baker
