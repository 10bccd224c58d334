// SPDX-License-Identifier: MIT
#include "fake_godot.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>

namespace fake {

std::map<std::string, Class> classes;
std::vector<std::string> errors;
int64_t alive = 0;

namespace {

// A Variant holds its type, then a number, four floats, or a pointer.
struct Content {
  int32_t type;
  union {
    Bool bit;
    int64_t number;
    double real;
    float floats[4];
    void* pointer;
  };
};
static_assert(sizeof(Content) == 24, "as Godot's");
Content& content(Variant& v) { return *reinterpret_cast<Content*>(v.bytes); }
// Godot's Variants have 24 bytes: nothing here writes more.
void clear(Variant* v) { std::memset(static_cast<void*>(v), 0, sizeof(Content)); }
const Content& content(const Variant& v) { return *reinterpret_cast<const Content*>(v.bytes); }

template <typename T>
struct Counted {
  int references = 1;
  T value;
};
using Items = Counted<std::vector<Variant>>;
using Entries = Counted<std::map<std::string, Content>>;
using Bytes = Counted<std::vector<uint8_t>>;
using Text = Counted<std::string>;

std::map<uint64_t, Node*> nodes;

template <typename T>
void* make() {
  ++alive;
  return new T;
}

void release(Items* items) {
  if (--items->references > 0) return;
  for (Variant& item : items->value) destroy(item);
  --alive;
  delete items;
}
void release(Entries* entries) {
  if (--entries->references > 0) return;
  for (auto& entry : entries->value) destroy(reinterpret_cast<Variant&>(entry.second));
  --alive;
  delete entries;
}
template <typename T>
void release(T* shared) {
  if (--shared->references > 0) return;
  --alive;
  delete shared;
}

void* text_data(const std::string& text) {
  Text* const made = static_cast<Text*>(make<Text>());
  made->value = text;
  return made;
}
const std::string& text_at(const void* string) {
  static const std::string empty;
  const void* const data = *static_cast<void* const*>(string);
  return data == nullptr ? empty : static_cast<const Text*>(data)->value;
}

int* references_of(int32_t type, void* data) {
  switch (type) {
    case kString:
    case kStringName:
      return &static_cast<Text*>(data)->references;
    case kArray:
      return &static_cast<Items*>(data)->references;
    case kDictionary:
      return &static_cast<Entries*>(data)->references;
    case kPackedByteArray:
      return &static_cast<Bytes*>(data)->references;
    default:
      return nullptr;
  }
}

void release_data(int32_t type, void* data) {
  if (data == nullptr) return;
  if (type == kString || type == kStringName) release(static_cast<Text*>(data));
  if (type == kArray) release(static_cast<Items*>(data));
  if (type == kDictionary) release(static_cast<Entries*>(data));
  if (type == kPackedByteArray) release(static_cast<Bytes*>(data));
}

bool is_ref_counted(const Node* node) { return node->instance != nullptr || node->class_name == "Skin"; }

void drop_node(Node* node) {
  if (node == nullptr || !is_ref_counted(node) || --node->references > 0 || node->instance == nullptr) return;
  const Class& c = classes.at(node->class_name);
  c.info.free_instance(c.info.class_userdata, node->instance);
  nodes.erase(node->id);
  delete node;
}

std::size_t floats_of(int32_t type) { return type == kVector3 ? 3 : type == kQuaternion ? 4 : 0; }

void from_type(int32_t type, Variant* to, void* from) {
  Content& c = content(*to);
  clear(to);  // what was there is not looked at: it counts as memory without a value
  c.type = type;
  if (type == kBool) c.bit = *static_cast<Bool*>(from);
  if (type == kInt || type == kFloat) std::memcpy(&c.number, from, 8);
  if (floats_of(type) > 0) std::memcpy(c.floats, from, 4 * floats_of(type));
  if (type == kTransform3D) {
    ++alive;
    c.pointer = new Transform3D(*static_cast<Transform3D*>(from));
  }
  if (type == kObject) {
    c.pointer = *static_cast<void**>(from);
    if (c.pointer != nullptr && is_ref_counted(static_cast<Node*>(c.pointer)))
      ++static_cast<Node*>(c.pointer)->references;
  }
  const bool is_shared = type == kString || type == kStringName || type >= kDictionary;
  void* const data = is_shared ? *static_cast<void**>(from) : nullptr;
  if (is_shared) c.pointer = data;
  if (data != nullptr) ++*references_of(type, data);
}

void to_type(int32_t type, void* to, Variant* from) {
  const Content& c = content(*from);
  if (type == kString) {
    *static_cast<void**>(to) =
        c.type == kString || c.type == kStringName ? text_data(text_at(&c.pointer)) : text_data("?");
  } else if (type == kFloat && c.type == kInt) {
    const double real = static_cast<double>(c.number);
    std::memcpy(to, &real, 8);
  } else if (c.type != type) {
    errors.push_back("a Variant of type " + std::to_string(c.type) + " is taken for " + std::to_string(type));
  } else if (type == kBool) {
    *static_cast<Bool*>(to) = c.bit;
  } else if (floats_of(type) > 0) {
    std::memcpy(to, c.floats, 4 * floats_of(type));
  } else if (type == kTransform3D) {
    std::memcpy(to, c.pointer, sizeof(Transform3D));
  } else {
    std::memcpy(to, &c.number, 8);
    if (references_of(type, c.pointer) != nullptr) ++*references_of(type, c.pointer);
  }
}

void copy(Variant* to, const Variant* from) {
  const Content& c = content(*from);
  if (c.type == kNil) {
    clear(to);
  } else {
    from_type(c.type, to, c.type == kTransform3D ? c.pointer : const_cast<void*>(static_cast<const void*>(&c.number)));
  }
}

template <int32_t Type>
void from_one(Variant* to, void* from) {
  from_type(Type, to, from);
}
template <int32_t Type>
void to_one(void* to, Variant* from) {
  to_type(Type, to, from);
}
template <int32_t Type>
void destroy_one(void* value) {
  release_data(Type, *static_cast<void**>(value));
}
template <int32_t Type>
void construct_one(void* to, const void* const*) {
  *static_cast<void**>(to) = Type == kArray        ? make<Items>()
                             : Type == kDictionary ? make<Entries>()
                             : Type == kString     ? text_data("")
                                                   : make<Bytes>();
}

struct Functions {
  Interface::FromType from = nullptr;
  Interface::ToType to = nullptr;
  Interface::Destructor destroy = nullptr;
};
template <int32_t... Types>
std::map<int32_t, Functions> make_functions() {
  return {{Types, {from_one<Types>, to_one<Types>, destroy_one<Types>}}...};
}
// The functions of a type; null for a type that the addon has no use for.
Functions functions_of(int32_t type) {
  static const auto all = make_functions<kBool, kInt, kFloat, kString, kVector3, kQuaternion, kTransform3D, kStringName,
                                         kObject, kDictionary, kArray, kPackedByteArray>();
  const auto found = all.find(type);
  return found == all.end() ? Functions{} : found->second;
}
Interface::Constructor get_constructor(int32_t type, int32_t index) {
  if (index != 0) return nullptr;
  return type == kArray             ? construct_one<kArray>
         : type == kDictionary      ? construct_one<kDictionary>
         : type == kString          ? construct_one<kString>
         : type == kPackedByteArray ? construct_one<kPackedByteArray>
                                    : nullptr;
}

Variant of_type(int32_t type, const void* value) {
  Variant out;
  from_type(type, &out, const_cast<void*>(value));
  return out;
}
Variant of_bool(bool value) {
  const Bool bit = value;
  return of_type(kBool, &bit);
}

Variant call_node(Node& node, const std::string& method, const Variant* const* arguments, CallError* error) {
  const auto index = [&] { return static_cast<int>(int_of(*arguments[0])); };
  const auto bone = [&]() -> Node::Bone& { return node.bones.at(static_cast<std::size_t>(index())); };
  if (method == "is_class") return of_bool(node.class_name == text_of(*arguments[0]));
  if (method == "get_child_count") return of_int(static_cast<int64_t>(node.children.size()));
  if (method == "get_child") return of_node(node.children.at(static_cast<std::size_t>(index())));
  if (node.class_name == "MeshInstance3D" && method == "get_skin") return of_node(node.skin);
  if (node.class_name == "Skin") {
    if (method == "get_bind_count") return of_int(static_cast<int64_t>(node.bones.size()));
    if (method == "get_bind_bone") return of_int(-1);
    if (method == "get_bind_pose") return of_type(kTransform3D, &bone().inverse_bind);
    if (method == "get_bind_name") {
      StringName name{text_data(bone().name)};
      Variant out = of_type(kStringName, &name);
      release_data(kStringName, name.data);
      return out;
    }
  }
  if (node.class_name == "Skeleton3D") {
    if (method == "get_bone_count") return of_int(static_cast<int64_t>(node.bones.size()));
    if (method == "get_bone_name") return of_text(bone().name);
    if (method == "get_bone_parent") return of_int(bone().parent);
    if (method == "get_bone_pose_position") return of_type(kVector3, &bone().position);
    if (method == "get_bone_pose_rotation") return of_type(kQuaternion, &bone().rotation);
    if (method == "get_bone_pose_scale") {
      const Vector3 one{1, 1, 1};
      return of_type(kVector3, &one);
    }
    if (method == "set_bone_pose_rotation") {
      to_type(kQuaternion, &bone().rotation, const_cast<Variant*>(arguments[1]));
      ++node.turned;
      return {};
    }
    if (method == "get_bone_global_pose") {
      const Transform3D pose = global_pose(node, index());
      return of_type(kTransform3D, &pose);
    }
    if (method == "find_bone") {
      for (std::size_t i = 0; i < node.bones.size(); ++i) {
        if (node.bones[i].name == text_of(*arguments[0])) return of_int(static_cast<int64_t>(i));
      }
      return of_int(-1);
    }
  }
  error->code = 1;  // no such method
  return {};
}

void call(Variant* self, const StringName* name, const Variant* const* arguments, int64_t count, Variant* result,
          CallError* error) {
  const std::string& method = text_at(name);
  Content& c = content(*self);
  Variant out;
  error->code = kCallOk;
  if (c.type == kObject && c.pointer != nullptr) {
    out = call_node(*static_cast<Node*>(c.pointer), method, arguments, error);
  } else if (c.type == kArray && method == "push_back" && count == 1) {
    Variant item;
    copy(&item, arguments[0]);
    static_cast<Items*>(c.pointer)->value.push_back(item);
  } else if (c.type == kPackedByteArray && method == "size") {
    out = of_int(static_cast<int64_t>(static_cast<Bytes*>(c.pointer)->value.size()));
  } else {
    error->code = 1;
  }
  if (error->code != kCallOk && c.type != kNil) errors.push_back("there is no method " + method);
  std::memcpy(static_cast<void*>(result), &out, sizeof(Content));
}

const char kReadFile = 0;

const std::map<std::string, void*>& functions() {
#define FUNCTION(name, ...) \
  { #name, reinterpret_cast < void*>(static_cast <decltype(Interface::name)>(__VA_ARGS__)) }
  static const std::map<std::string, void*> table = {
      FUNCTION(print_error, [](const char* text, const char*, const char*, int32_t, Bool) { errors.push_back(text); }),
      FUNCTION(string_name_new_with_latin1_chars,
               [](StringName* to, const char* text, Bool) { to->data = text_data(text); }),
      FUNCTION(string_new_with_utf8_chars, [](String* to, const char* text) { to->data = text_data(text); }),
      FUNCTION(string_to_utf8_chars,
               [](const String* from, char* to, int64_t size) {
                 const std::string& text = text_at(from);
                 if (to != nullptr) std::memcpy(to, text.data(), std::min(text.size(), static_cast<std::size_t>(size)));
                 return static_cast<int64_t>(text.size());
               }),
      FUNCTION(variant_new_nil, [](Variant* to) { clear(to); }),
      FUNCTION(variant_new_copy, copy),
      FUNCTION(variant_destroy, [](Variant* value) { destroy(*value); }),
      FUNCTION(variant_get_type, [](const Variant* value) { return content(*value).type; }),
      FUNCTION(variant_call, call),
      FUNCTION(get_variant_from_type_constructor, [](int32_t type) { return functions_of(type).from; }),
      FUNCTION(get_variant_to_type_constructor, [](int32_t type) { return functions_of(type).to; }),
      FUNCTION(variant_get_ptr_constructor, get_constructor),
      FUNCTION(variant_get_ptr_destructor, [](int32_t type) { return functions_of(type).destroy; }),
      FUNCTION(dictionary_operator_index,
               [](Dictionary* in, const Variant* key) {
                 return reinterpret_cast<Variant*>(&static_cast<Entries*>(in->data)->value[text_of(*key)]);
               }),
      FUNCTION(packed_byte_array_operator_index_const,
               [](const PackedByteArray* in, int64_t i) -> const uint8_t* {
                 return static_cast<Bytes*>(in->data[0])->value.data() + i;
               }),
      FUNCTION(classdb_register_extension_class2,
               [](void*, const StringName* name, const StringName* parent, const ClassInfo2* info) {
                 if (text_at(parent) == "RefCounted") classes[text_at(name)].info = *info;
               }),
      FUNCTION(classdb_register_extension_class_method,
               [](void*, const StringName* name, const MethodInfo* info) {
                 const bool has_one = info->argument_count == 1;
                 classes.at(text_at(name)).methods[text_at(info->name)] = {
                     *info, has_one ? info->arguments->type : int32_t{kNil},
                     has_one ? text_at(info->arguments->class_name) : ""};
               }),
      FUNCTION(classdb_unregister_extension_class, [](void*, const StringName* name) { classes.erase(text_at(name)); }),
      FUNCTION(classdb_construct_object, [](const StringName* name) -> Object* { return make_node(text_at(name)); }),
      FUNCTION(classdb_get_method_bind,
               [](const StringName* owner, const StringName* name, int64_t hash) -> const void* {
                 const bool is_it =
                     text_at(owner) == "FileAccess" && text_at(name) == "get_file_as_bytes" && hash == 659035735;
                 return is_it ? &kReadFile : nullptr;
               }),
      FUNCTION(
          object_method_bind_ptrcall,
          [](const void* method, Object*, const void* const* arguments, void* result) {
            if (method != &kReadFile) return;
            std::ifstream file(text_at(arguments[0]), std::ios::binary);
            static_cast<Bytes*>(*static_cast<void**>(result))->value.assign(std::istreambuf_iterator<char>(file), {});
          }),
      FUNCTION(object_set_instance,
               [](Object* object, const StringName* name, void* instance) {
                 static_cast<Node*>(object)->class_name = text_at(name);
                 static_cast<Node*>(object)->instance = instance;
               }),
      FUNCTION(object_set_instance_binding,
               [](Object* object, void*, void* binding, const BindingCallbacks*) {
                 static_cast<Node*>(object)->binding = binding;
               }),
      FUNCTION(object_get_instance_binding,
               [](Object* object, void* token, const BindingCallbacks* callbacks) {
                 Node* const node = static_cast<Node*>(object);
                 return node->binding != nullptr ? node->binding : callbacks->create(token, object);
               }),
      FUNCTION(object_get_instance_from_id,
               [](uint64_t id) -> Object* { return nodes.count(id) == 0 ? nullptr : nodes.at(id); }),
      FUNCTION(object_get_instance_id, [](const Object* object) { return static_cast<const Node*>(object)->id; }),
  };
  return table;
}

}  // namespace

Node* make_node(const std::string& class_name) {
  Node* const node = new Node;
  node->class_name = class_name;
  static uint64_t last = 1000;
  node->id = ++last;
  nodes[node->id] = node;
  return node;
}

void forget(Node* node) { nodes.erase(node->id); }

void* get_proc_address(const char* name) { return functions().count(name) == 0 ? nullptr : functions().at(name); }

Transform3D global_pose(const Node& skeleton, int index) {
  const Node::Bone& bone = skeleton.bones.at(static_cast<std::size_t>(index));
  const Quaternion q = bone.rotation;
  const float own[9] = {
      1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - q.w * q.z),     2 * (q.x * q.z + q.w * q.y),
      2 * (q.x * q.y + q.w * q.z),     1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z - q.w * q.x),
      2 * (q.x * q.z - q.w * q.y),     2 * (q.y * q.z + q.w * q.x),     1 - 2 * (q.x * q.x + q.y * q.y)};
  const Transform3D above = bone.parent < 0 ? Transform3D{} : global_pose(skeleton, bone.parent);
  const float place[3] = {bone.position.x, bone.position.y, bone.position.z};
  Transform3D out;
  for (int row = 0; row < 3; ++row) {
    out.origin[row] = above.origin[row];
    for (int k = 0; k < 3; ++k) out.origin[row] += above.rows[3 * row + k] * place[k];
    for (int column = 0; column < 3; ++column) {
      out.rows[3 * row + column] = 0;
      for (int k = 0; k < 3; ++k) out.rows[3 * row + column] += above.rows[3 * row + k] * own[3 * k + column];
    }
  }
  return out;
}

Variant of_text(const std::string& text) {
  String string{text_data(text)};
  Variant out = of_type(kString, &string);
  release_data(kString, string.data);
  return out;
}
Variant of_node(Node* node) { return node == nullptr ? Variant{} : of_type(kObject, &node); }
Variant of_int(int64_t value) { return of_type(kInt, &value); }
Variant of_float(double value) { return of_type(kFloat, &value); }
std::string text_of(const Variant& value) { return text_at(&content(value).pointer); }
int64_t int_of(const Variant& value) {
  return content(value).type == kBool ? content(value).bit : content(value).number;
}
double float_of(const Variant& value) { return content(value).real; }
std::vector<Variant>& items_of(Variant& array) { return static_cast<Items*>(content(array).pointer)->value; }
Variant item_of(Variant& dictionary, const std::string& key) {
  Variant out;
  std::memcpy(out.bytes, &static_cast<Entries*>(content(dictionary).pointer)->value.at(key), sizeof(Content));
  return out;
}

void destroy(Variant& value) {
  Content& c = content(value);
  if (c.type == kTransform3D) {
    --alive;
    delete static_cast<Transform3D*>(c.pointer);
  } else if (c.type == kObject) {
    drop_node(static_cast<Node*>(c.pointer));
  } else if (c.type >= kString) {
    if (references_of(c.type, c.pointer) != nullptr) release_data(c.type, c.pointer);
  }
  clear(&value);
}

}  // namespace fake
