// SPDX-License-Identifier: MIT
// fuzz_asset [--stride N] [FILE.sphc ...]
// Opens an asset cut short at every length and with every byte and word changed in several ways, and uses whatever
// opens. Without files: a small synthetic asset with all optional parts. With --stride: only every N-th position; all
// of the header if N is below 100.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "tiny_skin.h"
#include "use_fully.h"

namespace spherechain::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Figures of floats: -1, 1e30, -1e30, NaN, and a thousand times what is there.
constexpr std::uint32_t kMinusOne = 0xBF800000, kHuge = 0x7149F2CA, kMinusHuge = 0xF149F2CA, kNoNumber = 0x7FC00000;
std::uint32_t thousandfold(std::uint32_t word) {
  float figure = 0;
  std::memcpy(&figure, &word, sizeof figure);
  figure *= 1000;
  std::memcpy(&word, &figure, sizeof figure);
  return word;
}

class Fuzzer {
 public:
  explicit Fuzzer(Bytes bytes) : bytes_(std::move(bytes)) {}

  bool run(const char* name, std::size_t stride) {
    if (!open_and_use(bytes_.size()) || opened_ != 1 || partly_ != 0) {
      std::fprintf(stderr, "fuzz_asset: %s: not a valid asset to start with: %s\n", name, message_);
      return false;
    }
    const bool sound = cut_short(stride) && change_bytes(stride) && change_words(stride);
    std::printf(
        "%s: %zu bytes, every %zu: %zu variants refused, %zu opened and used, of them %zu in part "
        "(hostile counts)\n",
        name, bytes_.size(), stride, refused_, opened_, partly_);
    if (sound && refused_ == 0) {
      std::fprintf(stderr, "fuzz_asset: %s: nothing was refused, so nothing was checked\n", name);
      return false;
    }
    return sound;
  }

 private:
  // The header is too small to leave a position out. A large asset's is like a small one's.
  static constexpr std::size_t kHeader = 128, kOfSmallAssets = 100;
  static std::size_t after(std::size_t i, std::size_t step, std::size_t stride) {
    return i + (i < kHeader && stride < kOfSmallAssets ? step : step * stride);
  }

  bool cut_short(std::size_t stride) {
    for (std::size_t size = 0; size < bytes_.size(); size = after(size, 1, stride)) {
      if (!open_and_use(size)) {
        return complain("cut short to", size);
      }
    }
    return true;
  }

  bool change_bytes(std::size_t stride) {
    for (std::size_t i = 0; i < bytes_.size(); i = after(i, 1, stride)) {
      const std::uint8_t original = bytes_[i];
      Bytes values = {0x00, 0xFF, static_cast<std::uint8_t>(original + 1)};
      for (unsigned bit = 0; bit < 8; ++bit) {
        values.push_back(static_cast<std::uint8_t>(original ^ (1U << bit)));
      }
      for (const std::uint8_t value : values) {
        bytes_[i] = value;
        if (value != original && !open_and_use(bytes_.size())) {
          return complain("with a changed byte at", i);
        }
      }
      bytes_[i] = original;
    }
    return true;
  }

  // Offsets, counts, indices and floats are words: extremes no single byte reaches.
  bool change_words(std::size_t stride) {
    const auto size = static_cast<std::uint32_t>(bytes_.size());
    for (std::size_t i = 0; i + 4 <= bytes_.size(); i = after(i, 4, stride)) {
      std::uint32_t original = 0;
      std::memcpy(&original, &bytes_[i], 4);
      for (const std::uint32_t value :
           {0U, 1U, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFFU, 0xFFFFFFFCU, size, size - 4U, 0x7F800000U, 0x00000001U,
            0x7F7FFFFFU, kMinusOne, kHuge, kMinusHuge, kNoNumber, thousandfold(original)}) {
        std::memcpy(&bytes_[i], &value, 4);
        if (!open_and_use(bytes_.size())) {
          return complain("with a changed word at", i);
        }
      }
      std::memcpy(&bytes_[i], &original, 4);
    }
    return true;
  }

  // The variant lives in a heap block of exactly its size, so that AddressSanitizer sees any read past it.
  bool open_and_use(std::size_t size) {
    const std::unique_ptr<std::uint8_t[]> block(new std::uint8_t[size]);
    std::copy(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(size), block.get());
    Asset asset;
    const Status status = sc_asset_open(&asset, SC_ABI_VERSION, block.get(), size, message_, sizeof message_);
    if (status != SC_OK) {
      ++refused_;
      return status.field == SC_FIELD_DATA && !is_open(&asset) && message_[0] != '\0';
    }
    ++opened_;
    const Use use = use_fully(asset);
    partly_ += use == Use::kPartly ? 1 : 0;
    return use != Use::kBroken;
  }

  bool complain(const char* what, std::size_t where) const {
    std::fprintf(stderr, "fuzz_asset: misbehaves %s %zu\n", what, where);
    return false;
  }

  Bytes bytes_;
  char message_[160] = {};
  std::size_t refused_ = 0, opened_ = 0, partly_ = 0;
};

bool fuzz_file(const char* path, std::size_t stride) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    std::fprintf(stderr, "fuzz_asset: %s: cannot be read\n", path);
    return false;
  }
  return Fuzzer(Bytes(std::istreambuf_iterator<char>(file), {})).run(path, stride);
}

}  // namespace
}  // namespace spherechain::test

int main(int argc, char** argv) {
  using namespace spherechain::test;
  std::size_t stride = 1;
  std::vector<const char*> files;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--stride") == 0 && i + 1 < argc) {
      stride = std::strtoul(argv[++i], nullptr, 10);
    } else {
      files.push_back(argv[i]);
    }
  }
  if (stride == 0) {
    std::fprintf(stderr, "usage: fuzz_asset [--stride N] [FILE.sphc ...], N at least 1\n");
    return 2;
  }
  bool sound = true;
  if (files.empty()) {
    // Bands, whose packed skin has every stream; and spheres with vertices of their own by the paper's rule.
    for (const unsigned spheres : {1U, 3U, 4U}) {
      const bool is_band = spheres != 3;
      TinyAsset tiny = is_band ? random_band(spheres, spheres) : random_asset(spheres, 1);
      tiny.parts.refit = is_band ? 1 : 0;
      const TinySkin skin = add_bones(tiny, 4, 2);
      add_skin(tiny, &skin, 3);
      const std::string name = std::to_string(spheres) + (is_band ? " spheres of a band" : " spheres of their own");
      sound = Fuzzer(build(tiny.parts)).run(name.c_str(), stride) && sound;
    }
  }
  for (const char* path : files) {
    sound = fuzz_file(path, stride) && sound;
  }
  return sound ? 0 : 1;
}
