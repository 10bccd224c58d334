// SPDX-License-Identifier: MIT
#include "values.h"

namespace spherechain::godot {

Interface api;
void* library = nullptr;

Value Value::from(int32_t type, const void* value) {
  Value out;
  api.get_variant_from_type_constructor(type)(&out.variant_, const_cast<void*>(value));
  return out;
}

Value Value::empty_array() {
  Array array;
  api.variant_get_ptr_constructor(kArray, 0)(&array, nullptr);
  Value out = from(kArray, &array);
  api.variant_get_ptr_destructor(kArray)(&array);
  return out;
}

Value Value::of(bool value) {
  const Bool bit = value ? 1 : 0;
  return from(kBool, &bit);
}

Value Value::of(int64_t value) { return from(kInt, &value); }
Value Value::of(double value) { return from(kFloat, &value); }

Value Value::of(const char* utf8) {
  String string;
  api.string_new_with_utf8_chars(&string, utf8);
  Value out = from(kString, &string);
  api.variant_get_ptr_destructor(kString)(&string);
  return out;
}

Value Value::of_object(Object* object) { return object == nullptr ? Value() : from(kObject, &object); }

std::string Value::as_text() const {
  if (type() != kString && type() != kStringName) return {};
  String string;  // Godot converts a StringName, too
  api.get_variant_to_type_constructor(kString)(&string, const_cast<Variant*>(&variant_));
  std::string out = text_of(string);
  api.variant_get_ptr_destructor(kString)(&string);
  return out;
}

Value Value::call_list(const Name& method, const Variant* const* arguments, int64_t count) {
  Value out;
  CallError error;
  api.variant_call(&variant_, &method.value, arguments, count, &out.variant_, &error);
  return error.code == kCallOk ? std::move(out) : Value();
}

std::string text_of(const String& string) {
  std::string out(static_cast<std::size_t>(api.string_to_utf8_chars(&string, nullptr, 0)), '\0');
  api.string_to_utf8_chars(&string, out.data(), static_cast<int64_t>(out.size()));
  return out;
}

void print_error(const std::string& text) { api.print_error(text.c_str(), "spherechain", "addons/spherechain", 0, 1); }

}  // namespace spherechain::godot
