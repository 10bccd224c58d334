// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/report/preview.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>

#include "baker/mesh/error.h"
#include "baker/segment/region_colours.h"
#include "baker/write/version.h"

namespace spherechain::baker {
namespace {

template <typename T, std::size_t N>
using Elements = std::vector<std::array<T, N>>;

std::array<float, 3> to_float(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
std::vector<double> to_numbers(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

template <typename T>
constexpr int component_type() {
  if constexpr (std::is_same_v<T, float>) return TINYGLTF_COMPONENT_TYPE_FLOAT;
  if constexpr (std::is_same_v<T, std::uint16_t>) return TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
  if constexpr (std::is_same_v<T, std::uint32_t>) return TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

// Appends to the one buffer; every element's size is a multiple of 4, so accessors are aligned. `target` 0: neither
// vertices nor indices.
int add_accessor(tinygltf::Model& model, const void* data, std::size_t bytes, std::size_t count, int component,
                 int type, int target) {
  std::vector<unsigned char>& buffer = model.buffers.front().data;
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = buffer.size();
  view.byteLength = bytes;
  view.target = target;
  const auto* first = static_cast<const unsigned char*>(data);
  buffer.insert(buffer.end(), first, first + bytes);
  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(model.bufferViews.size());
  accessor.componentType = component;
  accessor.count = count;
  accessor.type = type;
  model.bufferViews.push_back(std::move(view));
  model.accessors.push_back(std::move(accessor));
  return static_cast<int>(model.accessors.size()) - 1;
}

template <typename T, std::size_t N>
int add_vertices(tinygltf::Model& model, const Elements<T, N>& elements) {
  return add_accessor(model, elements.data(), elements.size() * sizeof(elements[0]), elements.size(),
                      component_type<T>(), static_cast<int>(N), TINYGLTF_TARGET_ARRAY_BUFFER);
}

int add_positions(tinygltf::Model& model, const Elements<float, 3>& positions) {
  const int id = add_vertices(model, positions);
  tinygltf::Accessor& accessor = model.accessors.back();  // glTF asks for the bounds of positions
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [least, most] = std::minmax_element(positions.begin(), positions.end(),
                                                   [k](const auto& a, const auto& b) { return a[k] < b[k]; });
    accessor.minValues.push_back((*least)[k]);
    accessor.maxValues.push_back((*most)[k]);
  }
  return id;
}

int add_indices(tinygltf::Model& model, const std::vector<Triangle>& triangles) {
  return add_accessor(model, triangles.data(), triangles.size() * sizeof(Triangle), 3 * triangles.size(),
                      component_type<Index>(), TINYGLTF_TYPE_SCALAR, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
}

int add_material(tinygltf::Model& model, const char* name, double white, double opacity) {
  tinygltf::Material material;
  material.name = name;
  material.pbrMetallicRoughness.baseColorFactor = {white, white, white, opacity};
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = 0.8;
  if (opacity < 1) material.alphaMode = "BLEND";
  model.materials.push_back(std::move(material));
  return static_cast<int>(model.materials.size()) - 1;
}

int add_mesh(tinygltf::Model& model, const char* name, std::map<std::string, int> attributes, int indices,
             int material) {
  tinygltf::Primitive primitive;
  primitive.attributes = std::move(attributes);
  primitive.indices = indices;
  primitive.material = material;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  tinygltf::Mesh mesh;
  mesh.name = name;
  mesh.primitives.push_back(std::move(primitive));
  model.meshes.push_back(std::move(mesh));
  return static_cast<int>(model.meshes.size()) - 1;
}

// `parent` -1: a root of the scene.
int add_node(tinygltf::Model& model, tinygltf::Node node, int parent) {
  const auto id = static_cast<int>(model.nodes.size());
  model.nodes.push_back(std::move(node));
  (parent < 0 ? model.scenes.front().nodes : model.nodes[static_cast<std::size_t>(parent)].children).push_back(id);
  return id;
}

// glTF's colours are linear.
std::array<float, 3> to_linear(Colour colour) {
  for (float& c : colour) c = c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
  return colour;
}

std::vector<Vec3> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3> normals(mesh.positions.size(), Vec3::Zero());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index v : mesh.triangles[t]) normals[v] += triangle_cross(mesh, t);
  }
  for (Vec3& n : normals) n = n.isZero(0) ? Vec3::UnitY() : Vec3(n.stableNormalized());
  return normals;
}

struct PreviewSkin {
  Elements<float, 3> positions, normals, colours;
  Elements<std::uint16_t, 4> joints;
  Elements<float, 4> weights;
  std::vector<Triangle> triangles;
};

// A vertex between two regions is there once for each: colours end where the bake cut, and are not blended across.
void append(const Mesh& mesh, const std::vector<std::uint8_t>& region_of_triangle,
            const std::vector<VertexWeights>& weights, PreviewSkin& skin) {
  const std::vector<Vec3> normals = vertex_normals(mesh);
  std::map<std::pair<std::uint8_t, Index>, Index> vertex_of;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint8_t region = region_of_triangle[t];
    Triangle triangle = mesh.triangles[t];
    for (Index& v : triangle) {
      const auto [entry, is_new] = vertex_of.try_emplace({region, v}, static_cast<Index>(skin.positions.size()));
      if (is_new) {
        skin.positions.push_back(to_float(mesh.positions[v]));
        skin.normals.push_back(to_float(normals[v]));
        skin.colours.push_back(to_linear(kRegionColours[region % kRegionColours.size()]));
        std::array<std::uint16_t, 4> joints;
        std::array<float, 4> shares;
        for (std::size_t k = 0; k < 4; ++k) {
          joints[k] = static_cast<std::uint16_t>(weights[v].joint[k]);
          shares[k] = static_cast<float>(weights[v].weight[k]);
        }
        skin.joints.push_back(joints);
        skin.weights.push_back(shares);
      }
      v = entry->second;
    }
    skin.triangles.push_back(triangle);
  }
}

// From weights of source vertices to those of a piece's.
std::vector<VertexWeights> weights_of(const std::vector<VertexWeights>& of_source,
                                      const std::vector<Index>& piece_of_source, const Mesh& piece) {
  std::vector<VertexWeights> out(piece.positions.size());
  for (std::size_t s = 0; s < of_source.size(); ++s) {
    if (piece_of_source[s] != kNoIndex) out[piece_of_source[s]] = of_source[s];
  }
  return out;
}

int add_skin_mesh(tinygltf::Model& model, const PreviewSkin& skin, bool rigged) {
  std::map<std::string, int> attributes{{"POSITION", add_positions(model, skin.positions)},
                                        {"NORMAL", add_vertices(model, skin.normals)},
                                        {"COLOR_0", add_vertices(model, skin.colours)}};
  if (rigged) {
    attributes["JOINTS_0"] = add_vertices(model, skin.joints);
    attributes["WEIGHTS_0"] = add_vertices(model, skin.weights);
  }
  const int indices = add_indices(model, skin.triangles);
  return add_mesh(model, "skin", std::move(attributes), indices, add_material(model, "skin", 1, 0.5));
}

// Adds a sphere of radius 1 around 0: rings of vertices from pole to pole.
int add_sphere_mesh(tinygltf::Model& model) {
  constexpr Index kRings = 15, kSegments = 32, kLast = kRings * kSegments + 1;
  Elements<float, 3> vertices{{0, 1, 0}};
  std::vector<Triangle> triangles;
  for (Index r = 1; r <= kRings; ++r) {
    const double polar = std::numbers::pi * r / (kRings + 1);
    for (Index s = 0; s < kSegments; ++s) {
      const double a = 2 * std::numbers::pi * s / kSegments;
      vertices.push_back(to_float({std::sin(polar) * std::sin(a), std::cos(polar), std::sin(polar) * std::cos(a)}));
      const Index here = 1 + (r - 1) * kSegments + s, next = 1 + (r - 1) * kSegments + (s + 1) % kSegments;
      if (r == 1) triangles.push_back({0, here, next});
      if (r < kRings) {
        triangles.push_back({here, here + kSegments, next});
        triangles.push_back({next, here + kSegments, next + kSegments});
      } else {
        triangles.push_back({here, kLast, next});
      }
    }
  }
  vertices.push_back({0, -1, 0});
  std::map<std::string, int> attributes{{"POSITION", add_positions(model, vertices)},
                                        {"NORMAL", add_vertices(model, vertices)}};
  const int indices = add_indices(model, triangles);
  return add_mesh(model, "sphere", std::move(attributes), indices, add_material(model, "sphere", 0.7, 1));
}

tinygltf::Node root_node(const Bake& bake) {
  const BodyFrame& frame = bake.regions.frame;
  const double scale = bake.character.metres_per_unit;
  Eigen::Matrix3d to_own;
  to_own << frame.left.transpose(), frame.up.transpose(), frame.forward.transpose();
  const Eigen::Quaterniond q = Eigen::Quaterniond(to_own).normalized();
  tinygltf::Node node;
  node.name = "character";
  node.translation = to_numbers(-scale * (to_own * frame.origin));
  node.rotation = {q.x(), q.y(), q.z(), q.w()};
  node.scale = {scale, scale, scale};
  return node;
}

// Joints rest unturned, so that a bind matrix is a translation.
int add_joints(tinygltf::Model& model, const std::vector<Joint>& joints, int root) {
  tinygltf::Skin skin;
  Elements<float, 16> inverse_bind;
  for (const Joint& joint : joints) {
    tinygltf::Node node;
    node.name = joint.name;
    const bool top = joint.parent < 0;
    node.translation = to_numbers(top ? joint.position
                                      : Vec3(joint.position - joints[static_cast<std::size_t>(joint.parent)].position));
    const int parent = top ? root : skin.joints[static_cast<std::size_t>(joint.parent)];
    skin.joints.push_back(add_node(model, std::move(node), parent));
    const std::array<float, 3> p = to_float(joint.position);
    inverse_bind.push_back({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -p[0], -p[1], -p[2], 1});  // by columns
  }
  skin.inverseBindMatrices = add_accessor(model, inverse_bind.data(), inverse_bind.size() * sizeof(inverse_bind[0]),
                                          inverse_bind.size(), component_type<float>(), TINYGLTF_TYPE_MAT4, 0);
  model.skins.push_back(std::move(skin));
  return static_cast<int>(model.skins.size()) - 1;
}

std::string sphere_name(const Regions& regions, const FittedSphere& sphere, std::size_t place) {
  const std::string region = regions.name(sphere.region);
  if (sphere.region != regions.torso_region()) return fmt::format("{}_{:02}", region, place);
  const char* side = sphere.side == Side::kLeft ? "_left" : sphere.side == Side::kRight ? "_right" : "";
  return fmt::format("{}_level_{}{}", region, sphere.level, side);
}

// The joint with the most weight over the sphere's pivots.
std::size_t carrier(const BoundSphere& sphere, const Mesh& skin, const std::vector<VertexWeights>& weights,
                    std::size_t joint_count) {
  std::vector<double> sum(joint_count, 0.0);
  for (const BoundPivot& pivot : sphere.pivots) {
    for (const Index v : skin.triangles[pivot.triangle]) {
      for (std::size_t k = 0; k < 4; ++k) sum[weights[v].joint[k]] += weights[v].weight[k];
    }
  }
  return static_cast<std::size_t>(std::max_element(sum.begin(), sum.end()) - sum.begin());
}

// Under the joints, or under the root where there are none.
void add_spheres(tinygltf::Model& model, const Bake& bake, const std::vector<VertexWeights>& weights, int root,
                 const std::vector<int>& joint_nodes) {
  const int mesh = add_sphere_mesh(model);
  for (const std::vector<std::uint32_t>& region : bake.spheres.of_region) {
    for (std::size_t place = 0; place < region.size(); ++place) {
      const BoundSphere& sphere = bake.binding.spheres[region[place]];
      tinygltf::Node node;
      node.name = sphere_name(bake.regions, bake.spheres.spheres[region[place]], place);
      node.mesh = mesh;
      // A preview that is baked again is the character alone.
      node.extras = tinygltf::Value(tinygltf::Value::Object{{"spherechain", tinygltf::Value("sphere")}});
      node.scale = std::vector<double>(3, sphere.rest.radius);
      if (bake.joints.empty()) {
        node.translation = to_numbers(sphere.rest.center);
        add_node(model, std::move(node), root);
        continue;
      }
      const std::size_t joint = carrier(sphere, bake.character.skin, weights, bake.joints.size());
      node.translation = to_numbers(sphere.rest.center - bake.joints[joint].position);
      add_node(model, std::move(node), joint_nodes[joint]);
    }
  }
}

}  // namespace

std::string preview_glb(const Bake& bake) {
  const Character& character = bake.character;
  std::vector<VertexWeights> weights(character.skin.positions.size());
  if (!bake.joints.empty()) {
    weights =
        weights_of(rig_weights(character, bake.regions.body, bake.joints), character.skin_of_source, character.skin);
  }
  PreviewSkin skin;
  append(character.skin, bake.regions.of_skin, weights, skin);

  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = std::string("spherechain ") + kVersion;
  model.buffers.resize(1);
  model.scenes.resize(1);
  model.defaultScene = 0;
  const int root = add_node(model, root_node(bake), -1);
  tinygltf::Node node;
  node.name = "skin";
  const bool rigged = !bake.joints.empty();
  if (rigged) node.skin = add_joints(model, bake.joints, root);
  node.mesh = add_skin_mesh(model, skin, rigged);
  add_node(model, std::move(node), rigged ? -1 : root);  // glTF places a skinned mesh by its joints alone
  add_spheres(model, bake, weights, root, rigged ? model.skins.front().joints : std::vector<int>());

  std::ostringstream bytes;
  if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, bytes, false, true)) {
    throw Error(ExitCode::kInternal, character.file + ": the preview cannot be serialized");
  }
  return std::move(bytes).str();
}

}  // namespace spherechain::baker
