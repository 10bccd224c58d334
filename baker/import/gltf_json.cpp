// SPDX-License-Identifier: GPL-3.0-or-later
// tinygltf takes members of a wrong type for absent ones, keeps indices as they are and recurses into extras: a hostile
// file is stopped here, before it.
#include "baker/import/gltf_json.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "baker/import/json_depth.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

using nlohmann::json;

constexpr int kDepthMax = 64;                              // recursion in tinygltf and here ends there
constexpr std::size_t kEntriesMax = std::size_t{1} << 18;  // of one array; a rich character has some thousand accessors
constexpr double kCountMax = 2147483647.0;                 // bytes or elements; tinygltf keeps some of them as int

constexpr const char* kKept[] = {
    "asset", "extensionsUsed", "extensionsRequired", "buffers", "bufferViews", "accessors", "meshes",
    "nodes", "skins",          "animations",         "scenes",  "scene"};

// Extensions that may be required without a say in where vertices are.
constexpr const char* kHarmless[] = {
    "KHR_mesh_quantization", "KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_",
    "KHR_lights_",           "EXT_lights_",    "KHR_xmp",      "VRM",          "MSFT_lod"};

// An object of the file, and how an error calls it.
class Object {
 public:
  Object(json& value, std::string where, const json& root, const std::string& file)
      : value_(value), where_(std::move(where)), root_(root), file_(file) {
    if (!value_.is_object()) throw Error(ExitCode::kFile, file_ + ": " + where_ + " is not an object");
  }

  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    throw Error(ExitCode::kFile, file_ + ": " + (where_.empty() ? "" : where_ + ".") + key + " " + what);
  }

  bool has(const char* key) const { return value_.contains(key); }
  void require(const char* key) const {
    if (!has(key)) fail(key, "is missing");
  }

  // A whole number of bytes or elements. JSON knows no integers: 36.0 is one.
  void count(const char* key) const {
    if (has(key)) whole(value_[key], key, kCountMax);
  }
  // An index into the root's array `of`.
  void index(const char* key, const char* of) const {
    if (has(key)) index_of(value_[key], key, of);
  }
  void indices(const char* key, const char* of) const {
    if (!has(key)) return;
    json& list = array(key);
    for (std::size_t i = 0; i < list.size(); ++i) index_of(list[i], entry(key, i), of);
  }
  void text(const char* key) const {
    if (has(key) && !value_[key].is_string()) fail(key, "is not a string");
  }
  void flag(const char* key) const {
    if (has(key) && !value_[key].is_boolean()) fail(key, "is not true or false");
  }
  // `size` 0: any number of them.
  void numbers(const char* key, std::size_t size = 0) const {
    if (!has(key)) return;
    const json& list = array(key);
    const bool good = (size == 0 || list.size() == size) && std::all_of(list.begin(), list.end(), [](const json& v) {
                        return v.is_number() && std::isfinite(v.get<double>());
                      });
    if (!good)
      fail(key, size == 0 ? "is not a list of numbers" : "is not a list of " + std::to_string(size) + " numbers");
  }

  Object object(const char* key) const { return {value_[key], inner(key), root_, file_}; }
  template <typename Each>
  void objects(const char* key, const Each& each) const {
    if (!has(key)) return;
    json& list = array(key);
    for (std::size_t i = 0; i < list.size(); ++i) each(Object(list[i], inner(entry(key, i)), root_, file_));
  }
  // Members that are indices of accessors, whatever their names.
  void accessors(const char* key) const {
    if (!has(key)) return;
    const Object members = object(key);
    members.accessors();
  }
  void accessors() const {
    for (auto& [name, value] : value_.items()) {
      if (name != "extensions") index_of(value, name, "accessors");
    }
  }
  std::size_t size_of(const char* key) const { return has(key) ? value_[key].size() : 0; }
  json& operator[](const char* key) const { return value_[key]; }

  json& array(const char* key) const {
    json& list = value_[key];
    if (!list.is_array()) fail(key, "is not a list");
    if (list.size() > kEntriesMax)
      fail(key, "has " + std::to_string(list.size()) + " entries, too many for a character");
    return list;
  }

 private:
  static std::string entry(const char* key, std::size_t i) { return std::string(key) + "[" + std::to_string(i) + "]"; }
  std::string inner(const std::string& key) const { return where_.empty() ? key : where_ + "." + key; }

  void whole(json& value, const std::string& key, double high) const {
    const double number = value.is_number() ? value.get<double>() : -1;
    if (!(number >= 0 && number <= high) || number != std::floor(number)) {
      fail(key,
           value.is_number() ? "is " + value.dump() + ", not a whole number in its range" : "is not a whole number");
    }
    value = static_cast<std::uint64_t>(number);
  }
  void index_of(json& value, const std::string& key, const char* of) const {
    whole(value, key, kCountMax);
    const std::size_t size = root_.contains(of) && root_[of].is_array() ? root_[of].size() : 0;
    if (value.get<std::size_t>() >= size) {
      fail(key, "is " + value.dump() + ", but there are " + std::to_string(size) + " " + of);
    }
  }

  json& value_;
  std::string where_;
  const json& root_;
  const std::string& file_;
};

void check_accessor(const Object& accessor) {
  accessor.index("bufferView", "bufferViews");
  accessor.count("byteOffset");
  accessor.require("componentType");
  accessor.count("componentType");
  accessor.require("count");
  accessor.count("count");
  accessor.require("type");
  accessor.text("type");
  accessor.flag("normalized");
  if (!accessor.has("sparse")) return;
  const Object sparse = accessor.object("sparse");
  sparse.require("count");
  sparse.count("count");
  for (const char* key : {"indices", "values"}) {
    sparse.require(key);
    const Object part = sparse.object(key);
    part.require("bufferView");
    part.index("bufferView", "bufferViews");
    part.count("byteOffset");
    part.count("componentType");
  }
  sparse.object("indices").require("componentType");
}

void check_mesh(const Object& mesh) {
  mesh.text("name");
  mesh.require("primitives");
  mesh.numbers("weights");
  mesh.objects("primitives", [](const Object& primitive) {
    primitive.require("attributes");
    primitive.accessors("attributes");
    primitive.index("indices", "accessors");
    primitive.count("mode");
    primitive.objects("targets", [](const Object& target) { target.accessors(); });
  });
}

void check_node(const Object& node) {
  node.text("name");
  node.index("mesh", "meshes");
  node.index("skin", "skins");
  node.indices("children", "nodes");
  node.numbers("matrix", 16);
  node.numbers("translation", 3);
  node.numbers("rotation", 4);
  node.numbers("scale", 3);
  node.numbers("weights");
}

void check_skin(const Object& skin) {
  skin.require("joints");
  skin.indices("joints", "nodes");
  std::vector<std::size_t> joints = skin["joints"];
  std::sort(joints.begin(), joints.end());
  if (joints.empty() || std::adjacent_find(joints.begin(), joints.end()) != joints.end()) {
    skin.fail("joints", joints.empty() ? "is empty" : "names a node twice");
  }
  skin.index("inverseBindMatrices", "accessors");
}

void check_animation(const Object& animation) {
  animation.text("name");
  animation.objects("samplers", [](const Object& sampler) {
    for (const char* key : {"input", "output"}) {
      sampler.require(key);
      sampler.index(key, "accessors");
    }
    sampler.text("interpolation");
  });
  animation.objects("channels", [&](const Object& channel) {
    channel.require("sampler");
    channel.count("sampler");
    if (channel["sampler"].get<std::size_t>() >= animation.size_of("samplers")) {
      channel.fail("sampler", "is " + channel["sampler"].dump() + ", but there are " +
                                  std::to_string(animation.size_of("samplers")) + " samplers");
    }
    channel.require("target");
    const Object target = channel.object("target");
    target.index("node", "nodes");
    target.require("path");
    target.text("path");
  });
}

void check_members(json& root, const std::string& file) {
  const Object top(root, "", root, file);
  top.objects("buffers", [](const Object& buffer) {
    buffer.require("byteLength");
    buffer.count("byteLength");
    buffer.text("uri");
  });
  top.objects("bufferViews", [](const Object& view) {
    view.require("buffer");
    view.index("buffer", "buffers");
    view.count("byteOffset");
    view.require("byteLength");
    view.count("byteLength");
    view.count("byteStride");
  });
  top.objects("accessors", check_accessor);
  top.objects("meshes", check_mesh);
  top.objects("nodes", check_node);
  top.objects("skins", check_skin);
  top.objects("animations", check_animation);
  top.objects("scenes", [](const Object& scene) { scene.indices("nodes", "nodes"); });
  if (root.contains("scenes")) {
    top.index("scene", "scenes");
  } else {
    root.erase("scene");
  }
}

void check_extensions(const json& root, const std::string& file) {
  if (!root.contains("extensionsRequired")) return;
  for (const json& required : root["extensionsRequired"]) {
    const std::string name = required.is_string() ? required.get<std::string>() : required.dump();
    const bool harmless = std::any_of(std::begin(kHarmless), std::end(kHarmless),
                                      [&](const char* known) { return name.rfind(known, 0) == 0; });
    if (!harmless) {
      throw Error(ExitCode::kFile,
                  file + ": needs the glTF extension " + name + ", which is not read (export without it)");
    }
  }
}

// Extensions whose contents tinygltf 2.9 requires. They go as a whole: coarse_nodes() has read what is needed of them.
constexpr const char* kAskedFor[] = {"KHR_lights_punctual", "KHR_audio", "MSFT_lod"};

// Leaves of `extras` the names of morph targets, of other extensions their names.
void strip(json& value) {
  if (value.is_object()) {
    if (const auto extras = value.find("extras"); extras != value.end()) {
      json names;
      if (extras->is_object() && extras->contains("targetNames")) names = std::move((*extras)["targetNames"]);
      const bool list = names.is_array() &&
                        std::all_of(names.begin(), names.end(), [](const json& name) { return name.is_string(); });
      *extras = list ? json{{"targetNames", std::move(names)}} : json::object();
    }
    if (const auto extensions = value.find("extensions"); extensions != value.end()) {
      if (!extensions->is_object()) *extensions = json::object();
      for (json& content : *extensions) content = json::object();
      for (const char* name : kAskedFor) extensions->erase(name);
    }
  }
  if (value.is_structured()) {
    for (json& inner : value) strip(inner);
  }
}

// A VRM avatar's humanoid says which node is which bone of a body: VRM 0 in a list, VRM 1 bone by bone.
void keep_humanoid(const json& all, json& root) {
  for (const char* place : {"/extensions/VRM/humanoid/humanBones", "/extensions/VRMC_vrm/humanoid/humanBones"}) {
    const json::json_pointer bones(place);
    if (!all.contains(bones)) continue;
    for (const auto& [key, bone] : all[bones].items()) {
      if (!bone.is_object() || !bone.contains("node") || !bone["node"].is_number_unsigned()) continue;
      const auto node = bone["node"].get<std::size_t>();
      const json name = bone.contains("bone") ? bone["bone"] : json(key);
      if (name.is_string() && root.contains("nodes") && node < root["nodes"].size()) {
        root["nodes"][node]["extras"]["humanoid"] = name;
      }
    }
  }
}

// The nodes that MSFT_lod has for coarser levels of other nodes.
std::set<std::size_t> coarse_nodes(const json& root) {
  const json::json_pointer place("/extensions/MSFT_lod/ids");
  std::set<std::size_t> out;
  if (!root.contains("nodes")) return out;
  for (const json& node : root["nodes"]) {
    if (!node.contains(place)) continue;
    for (const json& id : node[place]) {
      if (id.is_number_unsigned() && id.get<std::size_t>() < root["nodes"].size()) out.insert(id.get<std::size_t>());
    }
  }
  return out;
}

// The nodes of a preview's spheres: bake --preview marks them.
std::set<std::size_t> preview_spheres(const json& root) {
  std::set<std::size_t> out;
  if (!root.contains("nodes")) return out;
  for (std::size_t n = 0; n < root["nodes"].size(); ++n) {
    const json& node = root["nodes"][n];
    if (node.contains("extras") && node["extras"].is_object() && node["extras"].contains("spherechain")) out.insert(n);
  }
  return out;
}

// Texts. Nothing that is wrong with a picture stops an import.
json uris_of_images(const json& all) {
  json uris = json::array();
  if (!all.contains("images")) return uris;
  for (const json& image : all["images"]) {
    if (image.is_object() && image.contains("uri") && image["uri"].is_string()) uris.push_back(image["uri"]);
  }
  return uris;
}

// Materials tell what their triangles are by their names.
json names_of_materials(const json& all) {
  json out = json::array();
  if (!all.contains("materials") || !all["materials"].is_array()) return out;
  for (const json& material : all["materials"]) {
    const bool is_named = material.is_object() && material.contains("name") && material["name"].is_string();
    out.push_back({{"name", is_named ? material["name"] : json("")}});
  }
  return out;
}

}  // namespace

json check_gltf_json(std::string_view text, const std::string& file) {
  if (json_depth(text) > kDepthMax) throw Error(ExitCode::kFile, file + ": its JSON is nested too deeply");
  json all;
  try {
    all = json::parse(text);
  } catch (const json::parse_error& error) {
    throw Error(ExitCode::kFile, file + ": its JSON is broken at byte " + std::to_string(error.byte));
  } catch (const json::out_of_range&) {
    throw Error(ExitCode::kFile, file + ": its JSON has a number that is not finite");
  }
  if (!all.is_object() || !all.contains("asset") || !all["asset"].is_object() || !all["asset"].contains("version") ||
      !all["asset"]["version"].is_string()) {
    throw Error(ExitCode::kFile, file + ": is not a glTF file (asset.version is missing)");
  }
  const auto version = all["asset"]["version"].get<std::string>();
  if (version.rfind("2.", 0) != 0) {
    throw Error(ExitCode::kFile, file + ": is glTF " + version + ", but only glTF 2 is read");
  }
  json root;
  for (const char* key : kKept) {
    if (all.contains(key)) root[key] = std::move(all[key]);
  }
  for (const auto& [key, value] : root.items()) {
    if (key != "asset" && key != "scene" && !value.is_array()) {
      throw Error(ExitCode::kFile, file + ": " + key + " is not a list");
    }
  }
  check_extensions(root, file);
  check_members(root, file);
  const std::set<std::size_t> coarse = coarse_nodes(root), spheres = preview_spheres(root);
  strip(root);
  keep_humanoid(all, root);
  for (const std::size_t node : coarse) root["nodes"][node]["extras"]["coarse"] = true;
  for (const std::size_t node : spheres) root["nodes"][node]["extras"]["spherechain"] = true;
  root["images"] = uris_of_images(all);
  root["materials"] = names_of_materials(all);
  return root;
}

}  // namespace spherechain::baker
