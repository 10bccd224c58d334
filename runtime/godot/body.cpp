// SPDX-License-Identifier: MIT
#include <cstring>

#include "classes.h"
#include "names.h"

namespace spherechain::godot {

// Godot's importers write _ for two characters that its bones cannot have: "mixamorig:Hips" becomes "mixamorig_Hips".
static std::string imported_name(const char* name) {
  std::string out = name;
  for (char& c : out) {
    if (c == ':' || c == '/') c = '_';
  }
  return out;
}

static void write_rows(const Transform3D& from, float* to) {
  for (int row = 0; row < 3; ++row) {
    std::memcpy(to + 4 * row, from.rows + 3 * row, 3 * sizeof(float));
    to[4 * row + 3] = from.origin[row];
  }
}

// a times b, rows of four; `to` may be neither.
static void multiply(const float* a, const float* b, float* to) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      to[4 * row + column] = a[4 * row] * b[column] + a[4 * row + 1] * b[4 + column] + a[4 * row + 2] * b[8 + column] +
                             (column == 3 ? a[4 * row + 3] : 0);
    }
  }
}

bool SkeletonBody::load(const std::string& path) {
  ++generation_;
  body_ = Body();
  model_ = Model();
  asset_.clear();
  // FileAccess reads what is inside an exported game, too. The number is the method's signature.
  const void* const method =
      api.classdb_get_method_bind(&names().FileAccess.value, &names().get_file_as_bytes.value, 659035735);
  if (method == nullptr) {
    print_error("SpherechainBody.load: this Godot has another FileAccess.get_file_as_bytes");
    return false;
  }
  String name;
  api.string_new_with_utf8_chars(&name, path.c_str());
  PackedByteArray bytes;
  api.variant_get_ptr_constructor(kPackedByteArray, 0)(&bytes, nullptr);
  const void* const arguments[] = {&name};
  api.object_method_bind_ptrcall(method, nullptr, arguments, &bytes);
  asset_size_ = static_cast<std::size_t>(Value::of(bytes).call(names().size).as_int());
  asset_.resize((asset_size_ + 7) / 8);
  if (asset_size_ > 0) {
    std::memcpy(asset_.data(), api.packed_byte_array_operator_index_const(&bytes, 0), asset_size_);
  }
  api.variant_get_ptr_destructor(kPackedByteArray)(&bytes);
  api.variant_get_ptr_destructor(kString)(&name);

  sc_asset asset;
  char message[256] = "the file is empty, or cannot be read";
  const Status status =
      asset_size_ == 0 ? Status{SC_NOT_AN_ASSET, SC_FIELD_DATA}
                       : sc_asset_open(&asset, SC_ABI_VERSION, asset_.data(), asset_size_, message, sizeof message);
  if (status == SC_OK) return true;
  asset_.clear();
  print_error("SpherechainBody.load: " + path + ": " + message);
  return false;
}

// Inverse bind matrices: those of the skins of the skeleton's meshes, as its importer made them.
void SkeletonBody::take_skins(Value& skeleton) {
  const int64_t children = skeleton.call(names().get_child_count).as_int();
  for (int64_t c = 0; c < children; ++c) {
    Value mesh = skeleton.call(names().get_child, Value::of(c));
    if (!mesh.call(names().is_class, Value::of("MeshInstance3D")).as_bool()) continue;
    Value skin = mesh.call(names().get_skin);
    const int64_t binds = skin.type() == kObject ? skin.call(names().get_bind_count).as_int() : 0;
    for (int64_t b = 0; b < binds; ++b) {
      const Value name = skin.call(names().get_bind_name, Value::of(b));
      int64_t bone = skin.call(names().get_bind_bone, Value::of(b)).as_int();
      if (!name.as_text().empty()) bone = skeleton.call(names().find_bone, Value::of(name.as_text().c_str())).as_int();
      const std::size_t at = static_cast<std::size_t>(bone);
      if (bone < 0 || at >= names_.size() || is_bound_[at]) continue;
      write_rows(skin.call(names().get_bind_pose, Value::of(b)).as_transform(), &inverse_binds_[12 * at]);
      is_bound_[at] = true;
    }
  }
}

bool SkeletonBody::bind(Object* object) {
  ++generation_;
  body_ = Body();
  model_ = Model();
  Value skeleton = Value::of_object(object);
  if (asset_.empty() || !skeleton.call(names().is_class, Value::of("Skeleton3D")).as_bool()) {
    print_error(asset_.empty() ? "SpherechainBody.bind: load() an asset first"
                               : "SpherechainBody.bind: pass a Skeleton3D");
    return false;
  }
  const std::size_t count = static_cast<std::size_t>(skeleton.call(names().get_bone_count).as_int());
  names_.assign(count, {});
  parents_.assign(count, SC_NO_JOINT);
  inverse_binds_.assign(12 * count, 0);
  is_bound_.assign(count, false);
  palette_.assign(12 * count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const Value index = Value::of(static_cast<int64_t>(i));
    names_[i] = skeleton.call(names().get_bone_name, index).as_text();
    const int64_t parent = skeleton.call(names().get_bone_parent, index).as_int();
    if (parent >= 0) parents_[i] = static_cast<uint32_t>(parent);
  }
  take_skins(skeleton);

  sc_asset asset;
  sc_asset_open(&asset, SC_ABI_VERSION, asset_.data(), asset_size_, nullptr, 0);
  const std::size_t asset_bones = sc_asset_get_info(&asset).bone_count;
  for (std::size_t b = 0; b < asset_bones; ++b) {  // the asset's spelling of the names
    const Bone bone = sc_asset_bone(&asset, b);
    for (std::string& name : names_) {
      if (name == imported_name(bone.name)) name = bone.name;
    }
  }
  std::vector<Bone> joints(count);
  for (std::size_t i = 0; i < count; ++i) {
    joints[i].name = names_[i].c_str();
    joints[i].inverse_bind = is_bound_[i] ? &inverse_binds_[12 * i] : nullptr;
  }
  ModelDef def;
  def.data = asset_.data();
  def.size = asset_size_;
  def.joints = joints.data();
  def.joint_count = count;
  def.inverse_bind_layout = SC_ROWS_3X4;
  model_ = Model(def);
  if (!model_) {
    print_error(std::string("SpherechainBody.bind: ") + model_.message());
    return false;
  }
  for (std::size_t b = 0; b < asset_bones; ++b) {  // no mesh with a skin is there: the asset's own matrices
    const Bone bone = sc_asset_bone(&asset, b);
    for (std::size_t i = 0; i < count; ++i) {
      if (is_bound_[i] || bone.inverse_bind == nullptr || names_[i] != bone.name) continue;
      std::memcpy(&inverse_binds_[12 * i], bone.inverse_bind, 12 * sizeof(float));
      is_bound_[i] = true;
    }
  }
  body_ = Body(model_);
  if (!body_) {
    print_error(std::string("SpherechainBody.bind: ") + code_text(body_.status()));
    return false;
  }
  skeleton_ = api.object_get_instance_id(object);
  return true;
}

bool SkeletonBody::set_pose(Value& skeleton) {
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (!is_bound_[i]) continue;
    float pose[12];
    write_rows(skeleton.call(names().get_bone_global_pose, Value::of(static_cast<int64_t>(i))).as_transform(), pose);
    multiply(pose, &inverse_binds_[12 * i], &palette_[12 * i]);
  }
  Pose pose;
  pose.bones = palette_.data();
  pose.bone_count = names_.size();
  pose.bone_layout = SC_ROWS_3X4;
  return body_.set_pose(pose) == SC_OK;
}

static const char* kind_of(sc_penetration_class kind) {
  switch (kind) {
    case SC_CLASS_INSIDE:
      return "inside";
    case SC_CLASS_PENETRATION:
      return "penetration";
    case SC_CLASS_DEEP_FOLD:
      return "deep fold";
    default:
      return "touch";
  }
}

Value SkeletonBody::described(const Penetration& found) {
  Dictionary dictionary;
  api.variant_get_ptr_constructor(kDictionary, 0)(&dictionary, nullptr);
  const auto set = [&](const char* key, const Value& value) {
    const Value name = Value::of(key);
    api.variant_new_copy(api.dictionary_operator_index(&dictionary, name.variant()), value.variant());  // it was nil
  };
  set("part", Value::of(model_.part_name(found.part)));
  set("other", Value::of(model_.part_name(found.other)));
  set("kind", Value::of(kind_of(found.kind)));
  set("bone", Value::of(found.joint == SC_NO_JOINT ? int64_t{-1} : int64_t{found.joint}));
  set("depth", Value::of(double{found.measures.depth}));
  set("position", Value::of(Vector3{found.deepest.position.x, found.deepest.position.y, found.deepest.position.z}));
  set("direction", Value::of(Vector3{found.direction.x, found.direction.y, found.direction.z}));
  set("distance", Value::of(double{found.distance}));
  Value out = Value::of(dictionary);
  api.variant_get_ptr_destructor(kDictionary)(&dictionary);
  return out;
}

Value SkeletonBody::penetrations() {
  Value list = Value::empty_array();
  Object* const object = skeleton();
  if (!body_ || object == nullptr) {
    print_error("SpherechainBody.penetrations: bind() a skeleton first");
    return list;
  }
  Value skeleton = Value::of_object(object);
  if (!set_pose(skeleton)) {
    print_error(std::string("SpherechainBody.penetrations: ") + field_name(body_.status()) + ": " +
                code_text(body_.status()));
    return list;
  }
  for (const Penetration& found : body_.penetrations()) list.call(names().push_back, described(found));
  return list;
}

}  // namespace spherechain::godot
