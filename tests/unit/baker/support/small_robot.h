// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "temporary_folder.h"

// A robot arm of one metre: a base, a lower arm on a hinge about z, and an upper arm on a hinge about y, with a tool
// that is fixed to it and a lamp whose hinge mimics the elbow.
namespace small_robot {

// The box from (-x, -y, 0) to (x, y, z), as a binary STL.
inline std::string box_stl(float x, float y, float z) {
  const auto corner = [&](int c) {
    return std::array<float, 3>{(c & 1) != 0 ? x : -x, (c & 2) != 0 ? y : -y, (c & 4) != 0 ? z : 0};
  };
  constexpr std::array<std::array<int, 4>, 6> kSides{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  std::string out(80, ' ');
  const auto put = [&](const auto& value) {
    char bytes[sizeof(value)];
    std::memcpy(bytes, &value, sizeof(value));
    out.append(bytes, sizeof(value));
  };
  put(std::uint32_t{12});
  for (const auto& side : kSides) {
    for (const auto& triangle : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
      put(std::array<float, 3>{});
      for (const int k : triangle) put(corner(side[static_cast<std::size_t>(k)]));
      put(std::uint16_t{0});
    }
  }
  return out;
}

inline const std::string kUrdf = R"(<?xml version="1.0"?>
<robot name="arm">
  <link name="base"><visual><geometry><box size="0.3 0.3 0.1"/></geometry></visual>
    <collision><geometry><box size="0.4 0.4 0.1"/></geometry></collision></link>
  <link name="lower"><visual><geometry><mesh filename="package://arm/meshes/link.stl"/></geometry></visual>
    <collision><origin xyz="0 0 0.25"/><geometry><box size="0.14 0.14 0.5"/></geometry></collision></link>
  <link name="upper"><visual><geometry><mesh filename="meshes/link.stl" scale="1 1 1.2"/></geometry></visual>
    <collision><origin xyz="0 0 0.3"/><geometry><cylinder radius="0.08" length="0.6"/></geometry></collision></link>
  <link name="flange"/>
  <link name="tool"><visual><origin xyz="0 0 0.05"/><geometry><sphere radius="0.06"/></geometry></visual></link>
  <link name="lamp"><visual><geometry><box size="0.02 0.02 0.02"/></geometry></visual></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="lower"/><origin xyz="0 0 0.06"/>
    <axis xyz="0 0 1"/></joint>
  <joint name="elbow" type="revolute"><parent link="lower"/><child link="upper"/><origin xyz="0 0.12 0.45"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="mount" type="fixed"><parent link="upper"/><child link="flange"/><origin xyz="0 0 0.6"/></joint>
  <joint name="grip" type="fixed"><parent link="flange"/><child link="tool"/></joint>
  <joint name="nod" type="revolute"><parent link="flange"/><child link="lamp"/><origin xyz="0.2 0 0"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
    <mimic joint="elbow" multiplier="-0.5" offset="0.1"/></joint>
</robot>
)";

// The files of the robot, in a package of a folder's name.
struct Files {
  TemporaryFolder temporary;
  std::filesystem::path folder = temporary.path / "arm";

  Files() {
    std::filesystem::create_directories(folder / "meshes");
    write("meshes/link.stl", box_stl(0.05F, 0.05F, 0.5F));
  }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }
  std::filesystem::path urdf(const std::string& text = kUrdf) const { return write("arm.urdf", text); }
};

inline std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  return at == text.npos ? "does not have " + from : text.replace(at, from.size(), to);
}

}  // namespace small_robot
