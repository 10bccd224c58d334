// SPDX-License-Identifier: MIT
// Godot's values with an owner in C++, and calls of its objects by name.
#pragma once

#include <string>
#include <utility>

#include "gdextension.h"

namespace spherechain::godot {

extern Interface api;
extern void* library;  // Godot's handle of this addon; also the token of its instance bindings

// A name that is made once, and destroyed with the addon.
struct Name {
  explicit Name(const char* text) { api.string_name_new_with_latin1_chars(&value, text, 0); }
  Name(const Name&) = delete;
  Name& operator=(const Name&) = delete;
  ~Name() { api.variant_get_ptr_destructor(kStringName)(&value); }
  StringName value;
};

// A Variant: owns what Godot keeps in it.
class Value {
 public:
  Value() { api.variant_new_nil(&variant_); }
  Value(Value&& other) noexcept {
    api.variant_new_nil(&variant_);
    std::swap(variant_, other.variant_);
  }
  Value& operator=(Value&& other) noexcept {
    std::swap(variant_, other.variant_);
    return *this;
  }
  ~Value() { api.variant_destroy(&variant_); }

  static Value empty_array();
  static Value of(bool value);
  static Value of(int64_t value);
  static Value of(double value);
  static Value of(const Vector3& value) { return from(kVector3, &value); }
  static Value of(const Quaternion& value) { return from(kQuaternion, &value); }
  static Value of(const Dictionary& value) { return from(kDictionary, &value); }
  static Value of(const PackedByteArray& value) { return from(kPackedByteArray, &value); }
  static Value of(const char* utf8);
  static Value of_object(Object* object);

  int32_t type() const { return api.variant_get_type(&variant_); }
  // The value, or a default where the type is another one.
  bool as_bool() const { return as<Bool>(kBool) != 0; }
  int64_t as_int() const { return as<int64_t>(kInt); }
  Vector3 as_vector3() const { return as<Vector3>(kVector3); }
  Quaternion as_quaternion() const { return as<Quaternion>(kQuaternion); }
  Transform3D as_transform() const { return as<Transform3D>(kTransform3D); }
  std::string as_text() const;  // of a String or StringName

  // Calls a method by its name. Nil where the object has no such method.
  template <typename... Arguments>
  Value call(const Name& method, const Arguments&... arguments) {
    const Variant* const list[] = {arguments.variant()..., nullptr};
    return call_list(method, list, sizeof...(Arguments));
  }

  const Variant* variant() const { return &variant_; }
  Variant* variant() { return &variant_; }

 private:
  static Value from(int32_t type, const void* value);
  Value call_list(const Name& method, const Variant* const* arguments, int64_t count);
  template <typename T>
  T as(int32_t wanted) const {
    T out{};
    if (type() == wanted) api.get_variant_to_type_constructor(wanted)(&out, const_cast<Variant*>(&variant_));
    return out;
  }

  Variant variant_;
};

std::string text_of(const String& string);
void print_error(const std::string& text);

}  // namespace spherechain::godot
