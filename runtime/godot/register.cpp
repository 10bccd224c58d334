// SPDX-License-Identifier: MIT
// Tells Godot of the two classes, and turns its calls into calls of theirs.
#include "classes.h"
#include "names.h"

#if defined(_WIN32)
#define SPHERECHAIN_ENTRY extern "C" __declspec(dllexport)
#else
#define SPHERECHAIN_ENTRY extern "C" __attribute__((visibility("default")))
#endif

namespace spherechain::godot {

static Names* all_names = nullptr;
const Names& names() { return *all_names; }

namespace {

// A method with at most one argument, as Godot calls it: pointers to values of these types.
struct Method {
  const char* name;
  int32_t result;    // kNil: none
  int32_t argument;  // kNil: none
  const char* argument_name;
  const char* argument_class;  // of an object
  void (*run)(void* instance, const void* argument, void* result);
};

SkeletonBody& body(void* instance) { return *static_cast<SkeletonBody*>(instance); }
SkeletonResponse& response(void* instance) { return *static_cast<SkeletonResponse*>(instance); }
Object* object_of(const void* argument) { return *static_cast<Object* const*>(argument); }

// The result is a value that Godot made already.
void set_array(void* result, const Value& value) {
  Array* const array = static_cast<Array*>(result);
  api.variant_get_ptr_destructor(kArray)(array);
  api.get_variant_to_type_constructor(kArray)(array, const_cast<Variant*>(value.variant()));
}

const Method kBodyMethods[] = {
    {"load", kBool, kString, "path", "",
     [](void* self, const void* path, void* result) {
       *static_cast<Bool*>(result) = body(self).load(text_of(*static_cast<const String*>(path)));
     }},
    {"bind", kBool, kObject, "skeleton", "Skeleton3D",
     [](void* self, const void* skeleton, void* result) {
       *static_cast<Bool*>(result) = body(self).bind(object_of(skeleton));
     }},
    {"penetrations", kArray, kNil, "", "",
     [](void* self, const void*, void* result) { set_array(result, body(self).penetrations()); }},
};

const Method kResponseMethods[] = {
    {"bind", kBool, kObject, "body", "SpherechainBody",
     [](void* self, const void* to, void* result) {
       *static_cast<Bool*>(result) = response(self).bind(object_of(to));
     }},
    {"apply", kInt, kFloat, "seconds", "",
     [](void* self, const void* seconds, void* result) {
       *static_cast<int64_t*>(result) = response(self).apply(*static_cast<const double*>(seconds));
     }},
    {"reset", kNil, kNil, "", "", [](void* self, const void*, void*) { response(self).reset(); }},
};

void call_typed(void* userdata, void* instance, const void* const* arguments, void* result) {
  const Method& method = *static_cast<const Method*>(userdata);
  method.run(instance, method.argument == kNil ? nullptr : arguments[0], result);
}

// A String may come as a StringName, a float as an int, an object as null.
bool fits(int32_t wanted, int32_t given) {
  return given == wanted || (wanted == kString && given == kStringName) || (wanted == kFloat && given == kInt) ||
         (wanted == kObject && given == kNil);
}

// The same with Variants: of scripts without types.
void call(void* userdata, void* instance, const Variant* const* arguments, int64_t count, Variant* result,
          CallError* error) {
  const Method& method = *static_cast<const Method*>(userdata);
  const int64_t expected = method.argument == kNil ? 0 : 1;
  api.variant_new_nil(result);
  if (count != expected) {
    *error = {count < expected ? kTooFewArguments : kTooManyArguments, 0, static_cast<int32_t>(expected)};
    return;
  }
  if (expected == 1 && !fits(method.argument, api.variant_get_type(arguments[0]))) {
    *error = {kInvalidArgument, 0, method.argument};
    return;
  }
  *error = {};
  alignas(8) unsigned char argument[16] = {};  // the largest: a String, an object, a double
  const bool is_null = expected == 1 && api.variant_get_type(arguments[0]) == kNil;
  if (expected == 1 && !is_null) {
    api.get_variant_to_type_constructor(method.argument)(argument, const_cast<Variant*>(arguments[0]));
  }
  alignas(8) unsigned char out[16] = {};
  if (method.result == kArray) api.variant_get_ptr_constructor(kArray, 0)(out, nullptr);
  method.run(instance, argument, out);
  if (method.result != kNil) {
    api.variant_destroy(result);
    api.get_variant_from_type_constructor(method.result)(result, out);
  }
  if (method.result == kArray) api.variant_get_ptr_destructor(kArray)(out);
  if (method.argument == kString) api.variant_get_ptr_destructor(kString)(argument);
}

const BindingCallbacks kBindings = {[](void*, void*) -> void* { return nullptr; }, [](void*, void*, void*) {},
                                    [](void*, void*, Bool) -> Bool { return 1; }};

// An instance binding names the class of its instance: a script may pass any object.
struct Bound {
  const void* kind;
  void* instance;
};

template <typename T>
struct Class {
  static inline const char kind = 0;
  static const StringName* name;

  struct Instance {
    T value;
    Bound bound{&kind, &value};
  };

  static Object* create(void*) {
    Object* const object = api.classdb_construct_object(&names().RefCounted.value);
    Instance* const instance = new Instance;
    api.object_set_instance(object, name, &instance->value);
    api.object_set_instance_binding(object, library, &instance->bound, &kBindings);
    return object;
  }
  static void destroy(void*, void* value) { delete reinterpret_cast<Instance*>(value); }  // its first field
};
template <typename T>
const StringName* Class<T>::name = nullptr;

template <typename T, std::size_t N>
void register_class(const Name& name, const Method (&methods)[N]) {
  Class<T>::name = &name.value;
  ClassInfo2 info;
  info.create_instance = Class<T>::create;
  info.free_instance = Class<T>::destroy;
  api.classdb_register_extension_class2(library, &name.value, &names().RefCounted.value, &info);
  String no_hint;
  api.string_new_with_utf8_chars(&no_hint, "");
  for (const Method& method : methods) {
    Name method_name(method.name), argument_name(method.argument_name), argument_class(method.argument_class),
        empty("");
    PropertyInfo argument{method.argument, &argument_name.value, &argument_class.value, 0, &no_hint, kUsageDefault};
    PropertyInfo result{method.result, &empty.value, &empty.value, 0, &no_hint, kUsageDefault};
    int32_t metadata = method.argument == kFloat ? 10 : 0;  // a double
    MethodInfo about{};
    about.name = &method_name.value;
    about.method_userdata = const_cast<Method*>(&method);
    about.call = call;
    about.ptrcall = call_typed;
    about.flags = 1;
    about.has_return_value = method.result != kNil;
    about.return_value = &result;
    about.argument_count = method.argument == kNil ? 0 : 1;
    about.arguments = &argument;
    about.arguments_metadata = &metadata;
    api.classdb_register_extension_class_method(library, &name.value, &about);
  }
  api.variant_get_ptr_destructor(kString)(&no_hint);
}

}  // namespace

template <>
SkeletonBody* instance_of(Object* object) {
  const Bound* const bound =
      object == nullptr ? nullptr : static_cast<Bound*>(api.object_get_instance_binding(object, library, &kBindings));
  return bound == nullptr || bound->kind != &Class<SkeletonBody>::kind ? nullptr
                                                                       : static_cast<SkeletonBody*>(bound->instance);
}

void register_classes() {
  all_names = new Names;
  register_class<SkeletonBody>(names().SpherechainBody, kBodyMethods);
  register_class<SkeletonResponse>(names().SpherechainResponse, kResponseMethods);
}

void unregister_classes() {
  api.classdb_unregister_extension_class(library, &names().SpherechainResponse.value);
  api.classdb_unregister_extension_class(library, &names().SpherechainBody.value);
  delete all_names;
  all_names = nullptr;
}

}  // namespace spherechain::godot

// Godot calls this once; addons/spherechain/spherechain.gdextension names it.
SPHERECHAIN_ENTRY uint8_t spherechain_godot_init(spherechain::godot::FunctionLookup get, void* library,
                                                 spherechain::godot::Initialization* initialization) {
  using namespace spherechain::godot;
  if (api.load(get) != nullptr) return 0;  // a Godot before 4.2
  spherechain::godot::library = library;
  initialization->minimum_level = kLevelScene;
  initialization->initialize = [](void*, int32_t level) {
    if (level == kLevelScene) register_classes();
  };
  initialization->deinitialize = [](void*, int32_t level) {
    if (level == kLevelScene) unregister_classes();
  };
  return 1;
}
