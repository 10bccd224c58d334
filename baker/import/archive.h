// SPDX-License-Identifier: GPL-3.0-or-later
// Writes an importer's result as bytes, and reads it back: from a child process to its parent, so neither order nor
// layout lasts.
#pragma once

#include <concepts>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "baker/import/import.h"

namespace spherechain::baker {

// Values that are their bytes. Eigen's of fixed size are, though they do not say so.
template <typename T>
inline constexpr bool kIsBytes = std::is_trivially_copyable_v<T>;
template <>
inline constexpr bool kIsBytes<Vec3> = true;
template <>
inline constexpr bool kIsBytes<Eigen::Quaterniond> = true;
template <>
inline constexpr bool kIsBytes<Affine> = true;

// The members of each struct, once for writing and reading.
template <typename T, typename Struct>
concept Is = std::same_as<std::remove_const_t<T>, Struct>;

void members(auto& io, Is<Node> auto& n) {
  io(n.name, n.humanoid_bone, n.is_attachment, n.parent, n.in_file, n.fbx_id, n.local, n.translation, n.rotation,
     n.scale);
}
void members(auto& io, Is<SourceBuffer> auto& b) {
  io(b.mesh, b.primitive, b.first_vertex, b.vertex_count, b.hash, b.triangle_count, b.name);
}
void members(auto& io, Is<Bone> auto& b) { io(b.node, b.inverse_bind); }
void members(auto& io, Is<Morph> auto& m) { io(m.name, m.vertices, m.deltas, m.rest_weight); }
void members(auto& io, Is<Channel> auto& c) { io(c.path, c.target, c.interpolation, c.times, c.values); }
void members(auto& io, Is<Clip> auto& c) { io(c.name, c.duration, c.in_file, c.fbx_id, c.channels); }
void members(auto& io, Is<RigJoint> auto& j) {
  io(j.name, j.kind, j.node, j.axis, j.anchor, j.zero, j.lower, j.upper, j.mimic, j.multiplier, j.offset);
}
void members(auto& io, Is<Mesh> auto& m) { io(m.positions, m.triangles); }
void members(auto& io, Is<RigCollider> auto& c) { io(c.bone, c.is_convex, c.mesh); }
void members(auto& io, Is<RobotRig> auto& r) {
  io(r.is_robot, r.name, r.bone_of, r.root, r.base, r.joints, r.excluded, r.colliders);
}
void members(auto& io, Is<SourceRig> auto& r) {
  io(r.nodes, r.bones, r.weights, r.morphs, r.clips, r.to_rest, r.pivots, r.robot);
}
void members(auto& io, Is<SourceLook> auto& l) { io(l.uvs, l.material_of, l.materials, l.pictures); }
void members(auto& io, Is<SourceMesh> auto& m) {
  io(m.positions, m.triangles, m.buffers, m.rig, m.look, m.importer, m.meshes, m.points_and_lines_dropped,
     m.bones_dropped, m.metres_per_unit, m.up_hint);
}

class ByteWriter {
 public:
  void operator()(const auto&... values) { (put(values), ...); }
  std::string bytes;

 private:
  template <typename T>
  void put(const T& value) {
    if constexpr (kIsBytes<T>)
      put_bytes(&value, 1);
    else
      members(*this, value);
  }
  void put(const std::string& text) { put_list(text); }
  template <typename T>
  void put(const std::vector<T>& list) {
    put_list(list);
  }
  template <typename List>
  void put_list(const List& list) {
    put(list.size());
    if constexpr (kIsBytes<typename List::value_type>)
      put_bytes(list.data(), list.size());
    else
      for (const auto& value : list) put(value);
  }
  template <typename T>
  void put_bytes(const T* values, std::size_t count) {
    bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
  }
};

// Throws std::out_of_range where the bytes are fewer than the values.
class ByteReader {
 public:
  explicit ByteReader(const std::string& bytes) : at_(bytes.data()), left_(bytes.size()) {}
  void operator()(auto&... values) { (get(values), ...); }

 private:
  template <typename T>
  void get(T& value) {
    if constexpr (kIsBytes<T>)
      get_bytes(&value, 1);
    else
      members(*this, value);
  }
  void get(std::string& text) { get_list(text); }
  template <typename T>
  void get(std::vector<T>& list) {
    get_list(list);
  }
  template <typename List>
  void get_list(List& list) {
    std::size_t size = 0;
    get(size);
    if (size > left_) throw std::out_of_range("an importer's answer is cut off");  // a value has a byte at least
    list.resize(size);
    if constexpr (kIsBytes<typename List::value_type>)
      get_bytes(list.data(), size);
    else
      for (auto& value : list) get(value);
  }
  template <typename T>
  void get_bytes(T* values, std::size_t count) {
    const std::size_t size = count * sizeof(T);
    if (size > left_) throw std::out_of_range("an importer's answer is cut off");
    if (size > 0) std::memcpy(static_cast<void*>(values), at_, size);
    at_ += size;
    left_ -= size;
  }

  const char* at_;
  std::size_t left_;
};

std::string to_bytes(const auto& value) {
  ByteWriter writer;
  writer(value);
  return std::move(writer.bytes);
}

template <typename T>
T from_bytes(const std::string& bytes) {
  T value;
  ByteReader reader(bytes);
  reader(value);
  return value;
}

}  // namespace spherechain::baker
