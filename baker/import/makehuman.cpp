// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/makehuman.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "baker/import/archive.h"
#include "baker/import/assimp_glb.h"
#include "baker/import/json_depth.h"
#include "baker/import/named_file.h"
#include "baker/import/read_in_child.h"
#include "baker/mesh/error.h"
#include "spherechain/asset.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

[[noreturn]] void fail_at(const fs::path& file, const std::string& what) {
  throw Error(ExitCode::kFile, file.string() + ": " + what);
}

std::string text_of_file(const fs::path& path) {
  check_regular_file(path);
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

json json_of_file(const fs::path& path) {
  const std::string text = text_of_file(path);
  constexpr int kDepthMax = 16;
  json out = json_depth(text) > kDepthMax ? json() : json::parse(text, nullptr, false);
  if (!out.is_object()) fail_at(path, "is no JSON of MakeHuman");
  return out;
}

// A slider stands for names in the file names of targets, and for a share of each.
using Shares = std::vector<std::pair<std::string, double>>;

Shares three(const std::string& name, double value) {
  const double most = std::max(0.0, 2 * value - 1), least = std::max(0.0, 1 - 2 * value);
  return {{"min" + name, least}, {"average" + name, 1 - most - least}, {"max" + name, most}};
}

Shares shares_of_age(double age) {
  constexpr double kChild = 0.1875, kYoung = 0.5;
  if (age >= kYoung) return {{"young", 2 - 2 * age}, {"old", 2 * age - 1}};
  if (age < kChild) return {{"baby", 1 - age / kChild}, {"child", age / kChild}};
  const double young = (age - kChild) / (kYoung - kChild);
  return {{"child", 1 - young}, {"young", young}};
}

// Targets and how far each is applied: the product of its names' shares.
std::map<std::string, double> targets_of(const MakeHumanBody& body) {
  const Shares genders{{"female", 1 - body.gender}, {"male", body.gender}},
      ages = shares_of_age(body.age), muscles = three("muscle", body.muscle), weights = three("weight", body.weight),
      heights = three("height", body.height),
      races{{"african", body.african}, {"asian", body.asian}, {"caucasian", body.caucasian}};
  std::map<std::string, double> out;
  for (const auto& [gender, of_gender] : genders) {
    for (const auto& [age, of_age] : ages) {
      const double share = of_gender * of_age;
      for (const auto& [race, of_race] : races) out[race + "-" + gender + "-" + age] = share * of_race;
      for (const auto& [muscle, of_muscle] : muscles) {
        for (const auto& [weight, of_weight] : weights) {
          const std::string name = gender + "-" + age + "-" + muscle + "-" + weight;
          out["universal-" + name] = share * of_muscle * of_weight;
          for (const auto& [height, of_height] : heights)
            out["height/" + name + "-" + height] = share * of_muscle * of_weight * of_height;
        }
      }
    }
  }
  return out;
}

class BodyMaker {
 public:
  explicit BodyMaker(const fs::path& data) : data_(data) {}

  SourceMesh make(const MakeHumanBody& body) {
    read_base();
    for (const auto& [name, share] : targets_of(body)) apply(name, share);
    if (applied_ == 0)
      fail_at(data_ / "targets/macrodetails", "has no .target file for this body (targets as text are read)");
    add_rig();
    keep_used_vertices();
    out_.importer = "makehuman";
    out_.meshes = 1;
    out_.metres_per_unit = 0.1;
    return std::move(out_);
  }

 private:
  // The base has guides for clothes and joints, too. Only the body is skin.
  void read_base() {
    const fs::path file = data_ / "3dobjs/base.obj";
    std::istringstream text(text_of_file(file));
    std::string line, group = "body";
    std::size_t number = 0;
    while (std::getline(text, line)) {
      ++number;
      std::istringstream words(line);
      std::string word;
      words >> word;
      if (word == "g") words >> group;
      if (word == "v") {
        Vec3 place;
        for (Eigen::Index k = 0; k < 3; ++k) words >> place[k];
        if (!words || !place.allFinite()) fail_at(file, fmt::format("line {}: no vertex", number));
        places_.push_back(place);
      }
      if (word != "f" || group != "body") continue;
      std::vector<Index> corners;
      while (words >> word) {
        const std::size_t corner = std::strtoul(word.c_str(), nullptr, 10);
        if (corner < 1 || corner > places_.size())
          fail_at(file, fmt::format("line {}: uses no vertex '{}'", number, word));
        corners.push_back(static_cast<Index>(corner - 1));
      }
      for (std::size_t k = 2; k < corners.size(); ++k)
        out_.triangles.push_back({corners[0], corners[k - 1], corners[k]});
    }
    if (out_.triangles.empty()) fail_at(file, "has no group 'body' of faces");
  }

  void apply(const std::string& name, double share) {
    const fs::path file = data_ / "targets/macrodetails" / (name + ".target");
    std::error_code ignored;
    if (share <= 0 || !fs::exists(file, ignored)) return;
    ++applied_;
    std::istringstream text(text_of_file(file));
    std::string line;
    for (std::size_t number = 1; std::getline(text, line); ++number) {
      if (line.find_first_not_of(" \t\r") == line.npos || line[0] == '#') continue;
      std::istringstream words(line);
      std::size_t vertex = 0;
      Vec3 offset;
      words >> vertex;
      for (Eigen::Index k = 0; k < 3; ++k) words >> offset[k];
      if (!words || vertex >= places_.size() || !offset.allFinite())
        fail_at(file, fmt::format("line {}: no vertex of the base and an offset", number));
      places_[vertex] += share * offset;
    }
  }

  // Joints are in the middle of vertices of the base, so they follow the targets.
  void add_rig() {
    const fs::path file = data_ / "rigs/default.mhskel";
    const json rig = json_of_file(file);
    try {
      const json &bones = rig.at("bones"), &joints = rig.at("joints");
      std::map<std::string, Index> added;
      for (bool grows = true; grows;) {  // parents first
        grows = false;
        for (const auto& [name, bone] : bones.items()) {
          const json& parent = bone.at("parent");
          const bool is_ready = parent.is_null() || added.count(parent.get<std::string>()) > 0;
          if (added.count(name) > 0 || !is_ready) continue;
          const int above = parent.is_null() ? -1 : static_cast<int>(added[parent.get<std::string>()]);
          added[name] = add_node(name, above, middle(joints.at(bone.at("head").get<std::string>())));
          grows = true;
        }
      }
      add_weights(rig, added);
    } catch (const json::exception& error) {
      fail_at(file, std::string("is no skeleton of MakeHuman (") + error.what() + ")");
    }
  }

  Vec3 middle(const json& vertices) const {
    Vec3 sum = Vec3::Zero();
    for (const json& vertex : vertices) sum += places_[index_of(vertex)];
    return vertices.empty() ? sum : Vec3(sum / static_cast<double>(vertices.size()));
  }
  std::size_t index_of(const json& vertex) const {
    const auto out = vertex.get<std::size_t>();
    if (out >= places_.size()) fail_at(data_ / "rigs", fmt::format("uses vertex {} of {}", out, places_.size()));
    return out;
  }

  Index add_node(const std::string& name, int parent, const Vec3& place) {
    Node node;
    node.name = name;
    node.parent = parent;
    node.in_file = static_cast<int>(out_.rig.nodes.size());
    node.translation = parent < 0 ? place : Vec3(place - joint_places_[static_cast<std::size_t>(parent)]);
    node.local.translation() = node.translation;
    Bone bone{static_cast<Index>(out_.rig.nodes.size()), Affine::Identity()};
    bone.inverse_bind.translation() = -place;
    out_.rig.bones.push_back(bone);
    out_.rig.nodes.push_back(std::move(node));
    joint_places_.push_back(place);
    return bone.node;
  }

  void add_weights(const json& rig, const std::map<std::string, Index>& bones) {
    fs::path file = data_ / "rigs/default_weights.mhw";
    if (rig.contains("weights_file")) {
      const NamedFile named = named_file(data_ / "rigs", rig["weights_file"].get<std::string>());
      if (!named.is_there)
        fail_at(data_ / "rigs/default.mhskel",
                fmt::format("its weights '{}' {}", rig["weights_file"].get<std::string>(), named.what_is_wrong()));
      file = named.path;
    }
    std::vector<std::map<Index, double>> of_vertex(places_.size());
    const json weights = json_of_file(file);
    for (const auto& [name, pairs] : weights.at("weights").items()) {
      const auto bone = bones.find(name);
      if (bone == bones.end()) continue;
      for (const json& pair : pairs) of_vertex[index_of(pair.at(0))][bone->second] += pair.at(1).get<double>();
    }
    for (const std::map<Index, double>& all : of_vertex) {
      std::vector<std::pair<double, Index>> sorted;
      for (const auto& [bone, weight] : all) {
        if (std::isfinite(weight) && weight > 0) sorted.emplace_back(-weight, bone);
      }
      std::sort(sorted.begin(), sorted.end());
      sorted.resize(std::min(sorted.size(), kMaxInfluences));
      double sum = 0;
      for (const auto& [weight, bone] : sorted) sum -= weight;
      VertexWeights of;
      for (std::size_t k = 0; k < sorted.size(); ++k) {
        of.joint[k] = sorted[k].second;
        of.weight[k] = -sorted[k].first / sum;
      }
      out_.rig.weights.push_back(of);
    }
  }

  void keep_used_vertices() {
    std::vector<Index> of_base(places_.size(), kNoIndex);
    for (const Triangle& triangle : out_.triangles) {
      for (const Index v : triangle) of_base[v] = 0;
    }
    std::vector<VertexWeights> weights;
    std::vector<float> packed;
    for (std::size_t v = 0; v < places_.size(); ++v) {
      if (of_base[v] == kNoIndex) continue;
      of_base[v] = static_cast<Index>(out_.positions.size());
      const Eigen::Vector3f place = places_[v].cast<float>();
      out_.positions.push_back(place.cast<double>());
      packed.insert(packed.end(), place.begin(), place.end());
      weights.push_back(out_.rig.weights[v]);
    }
    out_.rig.weights = std::move(weights);
    for (Triangle& triangle : out_.triangles) {
      for (Index& v : triangle) v = of_base[v];
    }
    const std::size_t count = out_.positions.size();
    out_.buffers.push_back({0, 0, 0, static_cast<Index>(count),
                            sc_hash_positions(packed.data(), count, 3 * sizeof(float)),
                            static_cast<Index>(out_.triangles.size()), "body"});
  }

  const fs::path& data_;
  std::vector<Vec3> places_, joint_places_;
  std::size_t applied_ = 0;
  SourceMesh out_;
};

}  // namespace

SourceMesh make_body(const std::filesystem::path& data, const MakeHumanBody& body) {
  return from_bytes<SourceMesh>(read_in_child(data.string(), [&] { return to_bytes(BodyMaker(data).make(body)); }));
}

std::string make_body_as_glb(const std::filesystem::path& data, const MakeHumanBody& body) {
  return glb_of(make_body(data, body));
}

}  // namespace spherechain::baker
