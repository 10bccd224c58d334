// SPDX-License-Identifier: MIT
// The part of Godot's extension interface that this addon uses, declared from its documentation. Godot gives each
// function by name: see Interface::load(). Sizes are those of a Godot with single precision, the usual build.
#pragma once

#include <cstdint>

namespace spherechain::godot {

// Values live in Godot's memory formats. Only Godot makes and destroys those that it counts references of.
using Bool = uint8_t;
using Object = void;  // handled by pointer alone
struct StringName {
  void* data = nullptr;
};
struct String {
  void* data = nullptr;
};
struct Array {
  void* data = nullptr;
};
struct Dictionary {
  void* data = nullptr;
};
struct PackedByteArray {
  void* data[2] = {};
};
struct Vector3 {
  float x = 0, y = 0, z = 0;
};
struct Quaternion {
  float x = 0, y = 0, z = 0, w = 1;
};
struct Transform3D {
  float rows[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  float origin[3] = {};
};
struct Variant {
  alignas(8) unsigned char bytes[40] = {};  // 24 are used; 40 with double precision
};

enum VariantType : int32_t {
  kNil = 0,
  kBool = 1,
  kInt = 2,
  kFloat = 3,
  kString = 4,
  kVector3 = 9,
  kQuaternion = 15,
  kTransform3D = 18,
  kStringName = 21,
  kObject = 24,
  kDictionary = 27,
  kArray = 28,
  kPackedByteArray = 29,
};

enum CallErrorCode : int32_t { kCallOk = 0, kInvalidArgument = 2, kTooManyArguments = 3, kTooFewArguments = 4 };
struct CallError {
  int32_t code = kCallOk;
  int32_t argument = 0;
  int32_t expected = 0;
};

struct PropertyInfo {
  int32_t type;
  StringName* name;
  StringName* class_name;
  uint32_t hint;
  String* hint_string;
  uint32_t usage;
};
constexpr uint32_t kUsageDefault = 6;  // stored, and shown in the editor

struct MethodInfo {
  StringName* name;
  void* method_userdata;
  void (*call)(void* userdata, void* instance, const Variant* const* arguments, int64_t count, Variant* result,
               CallError* error);
  void (*ptrcall)(void* userdata, void* instance, const void* const* arguments, void* result);
  uint32_t flags;  // 1: normal
  Bool has_return_value;
  PropertyInfo* return_value;
  int32_t return_value_metadata;
  uint32_t argument_count;
  PropertyInfo* arguments;
  int32_t* arguments_metadata;
  uint32_t default_argument_count;
  Variant** default_arguments;
};

// The second version of a class's description: Godot 4.2 and later take it.
struct ClassInfo2 {
  Bool is_virtual = 0, is_abstract = 0, is_exposed = 1;
  void *set = nullptr, *get = nullptr, *get_property_list = nullptr, *free_property_list = nullptr;
  void *property_can_revert = nullptr, *property_get_revert = nullptr, *validate_property = nullptr;
  void *notification = nullptr, *to_string = nullptr, *reference = nullptr, *unreference = nullptr;
  Object* (*create_instance)(void* class_userdata) = nullptr;
  void (*free_instance)(void* class_userdata, void* instance) = nullptr;
  void *recreate_instance = nullptr, *get_virtual = nullptr, *get_virtual_call_data = nullptr;
  void *call_virtual_with_data = nullptr, *get_rid = nullptr;
  void* class_userdata = nullptr;
};

struct BindingCallbacks {
  void* (*create)(void* token, void* object);
  void (*free)(void* token, void* object, void* binding);
  Bool (*reference)(void* token, void* binding, Bool is_reference);
};

enum InitializationLevel : int32_t { kLevelScene = 2 };
struct Initialization {
  int32_t minimum_level;
  void* userdata;
  void (*initialize)(void* userdata, int32_t level);
  void (*deinitialize)(void* userdata, int32_t level);
};
using FunctionLookup = void* (*)(const char* name);

// Functions of Godot. Each name is the one that Godot knows, and that of a field of Interface.
#define SPHERECHAIN_GODOT_FUNCTIONS(F)                                                                         \
  F(print_error, void, (const char*, const char*, const char*, int32_t, Bool))                                 \
  F(string_name_new_with_latin1_chars, void, (StringName*, const char*, Bool))                                 \
  F(string_new_with_utf8_chars, void, (String*, const char*))                                                  \
  F(string_to_utf8_chars, int64_t, (const String*, char*, int64_t))                                            \
  F(variant_new_nil, void, (Variant*))                                                                         \
  F(variant_new_copy, void, (Variant*, const Variant*))                                                        \
  F(variant_destroy, void, (Variant*))                                                                         \
  F(variant_get_type, int32_t, (const Variant*))                                                               \
  F(variant_call, void, (Variant*, const StringName*, const Variant* const*, int64_t, Variant*, CallError*))   \
  F(get_variant_from_type_constructor, FromType, (int32_t))                                                    \
  F(get_variant_to_type_constructor, ToType, (int32_t))                                                        \
  F(variant_get_ptr_constructor, Constructor, (int32_t, int32_t))                                              \
  F(variant_get_ptr_destructor, Destructor, (int32_t))                                                         \
  F(dictionary_operator_index, Variant*, (Dictionary*, const Variant*))                                        \
  F(packed_byte_array_operator_index_const, const uint8_t*, (const PackedByteArray*, int64_t))                 \
  F(classdb_register_extension_class2, void, (void*, const StringName*, const StringName*, const ClassInfo2*)) \
  F(classdb_register_extension_class_method, void, (void*, const StringName*, const MethodInfo*))              \
  F(classdb_unregister_extension_class, void, (void*, const StringName*))                                      \
  F(classdb_construct_object, Object*, (const StringName*))                                                    \
  F(classdb_get_method_bind, const void*, (const StringName*, const StringName*, int64_t))                     \
  F(object_method_bind_ptrcall, void, (const void*, Object*, const void* const*, void*))                       \
  F(object_set_instance, void, (Object*, const StringName*, void*))                                            \
  F(object_set_instance_binding, void, (Object*, void*, void*, const BindingCallbacks*))                       \
  F(object_get_instance_binding, void*, (Object*, void*, const BindingCallbacks*))                             \
  F(object_get_instance_from_id, Object*, (uint64_t))                                                          \
  F(object_get_instance_id, uint64_t, (const Object*))

struct Interface {
  using FromType = void (*)(Variant* to, void* from);
  using ToType = void (*)(void* to, Variant* from);
  using Constructor = void (*)(void* to, const void* const* arguments);
  using Destructor = void (*)(void* value);

#define F(name, result, arguments) result(*name) arguments = nullptr;
  SPHERECHAIN_GODOT_FUNCTIONS(F)
#undef F

  // The name of the first function that this Godot lacks, or null.
  const char* load(FunctionLookup get) {
#define F(name, result, arguments)                          \
  name = reinterpret_cast<result(*) arguments>(get(#name)); \
  if (name == nullptr) return #name;
    SPHERECHAIN_GODOT_FUNCTIONS(F)
#undef F
    return nullptr;
  }
};

}  // namespace spherechain::godot
