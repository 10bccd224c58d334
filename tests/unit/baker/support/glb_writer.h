// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

// Just enough to write a glTF by hand: its JSON, and a binary buffer that accessors are added to.
struct Glb {
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}};
  std::string binary;

  // Returns the buffer view's index.
  template <typename T>
  int view(const std::vector<T>& values) {
    binary.resize((binary.size() + 3) / 4 * 4);
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", values.size() * sizeof(T)}});
    binary.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }
  // Returns the accessor's index. `type` as glTF names it.
  template <typename T>
  int accessor(const std::vector<T>& values, const std::string& type, bool normalized = false) {
    json["accessors"].push_back({{"bufferView", view(values)},
                                 {"componentType", component<T>()},
                                 {"count", values.size() / width(type)},
                                 {"type", type},
                                 {"normalized", normalized}});
    return static_cast<int>(json["accessors"].size()) - 1;
  }

  std::string text() const { return with_buffer({{"byteLength", binary.size()}}).dump(); }
  std::string text(const std::string& uri) const {
    return with_buffer({{"byteLength", binary.size()}, {"uri", uri}}).dump();
  }
  std::string bytes() const { return container(text(), binary); }

  static std::string container(std::string text, std::string binary) {
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    return "glTF" + word(2) + word(12 + 8 + text.size() + 8 + binary.size()) + word(text.size()) + "JSON" + text +
           word(binary.size()) + std::string("BIN\0", 4) + binary;
  }
  static std::string word(std::size_t value) {
    const auto narrow = static_cast<std::uint32_t>(value);
    std::string bytes(4, '\0');
    std::memcpy(bytes.data(), &narrow, 4);
    return bytes;
  }
  static std::size_t width(const std::string& type) {
    return type == "SCALAR" ? 1 : type == "MAT4" ? 16 : static_cast<std::size_t>(type.back() - '0');
  }

 private:
  nlohmann::json with_buffer(const nlohmann::json& buffer) const {
    nlohmann::json out = json;
    if (!out.contains("buffers")) out["buffers"] = nlohmann::json::array({buffer});
    return out;
  }
  template <typename T>
  static int component() {
    if constexpr (std::is_same_v<T, std::int8_t>) return 5120;
    if constexpr (std::is_same_v<T, std::uint8_t>) return 5121;
    if constexpr (std::is_same_v<T, std::int16_t>) return 5122;
    if constexpr (std::is_same_v<T, std::uint16_t>) return 5123;
    if constexpr (std::is_same_v<T, std::uint32_t>) return 5125;
    if constexpr (std::is_same_v<T, float>) return 5126;
    return 0;
  }
};
