// SPDX-License-Identifier: MIT
// trial LIBRARY ASSET COPY: loads the addon as Godot does, with functions of a fake Godot, and goes from an asset to
// the first contact and to a response, by both kinds of calls. Every value that the addon took must be freed in the
// end.
#include <spherechain/spherechain.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include "fake_godot.h"

#if defined(_WIN32)
#include <windows.h>
#else
#include <dlfcn.h>
#endif

using namespace fake;

static void require(bool holds, const char* what) {
  if (holds) return;
  std::printf("FAILED: %s\n", what);
  for (const std::string& error : errors) std::printf("  %s\n", error.c_str());
  std::exit(1);
}

static void* entry_of(const char* library) {
#if defined(_WIN32)
  const HMODULE module = LoadLibraryA(library);
  return module == nullptr ? nullptr : reinterpret_cast<void*>(GetProcAddress(module, "spherechain_godot_init"));
#else
  void* const module = dlopen(library, RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) std::puts(dlerror());
  return module == nullptr ? nullptr : dlsym(module, "spherechain_godot_init");
#endif
}

// By Variants, as an untyped script does; `refused` is the error that is expected.
static Variant call(Node* node, const char* method, std::vector<Variant> arguments, int32_t refused = kCallOk) {
  const Class::Method& found = classes.at(node->class_name).methods.at(method);
  std::vector<const Variant*> list;
  for (const Variant& argument : arguments) list.push_back(&argument);
  Variant out;
  CallError error;
  found.info.call(found.info.method_userdata, node->instance, list.data(), static_cast<int64_t>(list.size()), &out,
                  &error);
  require(error.code == refused, method);
  for (Variant& argument : arguments) destroy(argument);
  return out;
}

// By pointers to values, as a typed script does.
static void call_typed(Node* node, const char* method, const void* argument, void* result) {
  const Class::Method& found = classes.at(node->class_name).methods.at(method);
  const void* const list[] = {argument};
  found.info.ptrcall(found.info.method_userdata, node->instance, list, result);
}

static Node* make(const char* name) {
  const Class& c = classes.at(name);
  Node* const node = static_cast<Node*>(c.info.create_instance(c.info.class_userdata));
  node->references = 1;  // the script's variable
  return node;
}

// The asset's bones, each below the bone that its body part hangs on. The file's name of one has a character that Godot
// lacks.
static Node* make_skeleton(const spherechain::Model& model) {
  const std::size_t count = model.info().bone_count;
  Node* const skeleton = make_node("Skeleton3D");
  Node* const skin = make_node("Skin");
  Node* const mesh = make_node("MeshInstance3D");
  skin->references = 1;  // the mesh's
  mesh->skin = skin;
  skeleton->children = {make_node("Node3D"), mesh};
  skeleton->bones.resize(count);
  skin->bones.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const spherechain::Bone bone = sc_asset_bone(&model.asset(), i);
    std::string name = bone.name;
    std::replace(name.begin(), name.end(), ':', '_');
    skeleton->bones[i].name = skin->bones[i].name = name;
    for (int row = 0; row < 3; ++row) {
      std::memcpy(skin->bones[i].inverse_bind.rows + 3 * row, bone.inverse_bind + 4 * row, 12);
      skin->bones[i].inverse_bind.origin[row] = bone.inverse_bind[4 * row + 3];
      require(std::abs(bone.inverse_bind[5 * row] - 1) < 1e-5f,
              "the trial's asset has bones that are not turned at rest");
    }
  }
  for (uint32_t p = 0; p < model.part_count(); ++p) {
    const spherechain::BodyPart part = model.part(p);
    const int parent = part.parent < 0 ? -1 : model.part(static_cast<uint32_t>(part.parent)).bone;
    if (part.bone >= 0 && parent != part.bone) skeleton->bones[static_cast<std::size_t>(part.bone)].parent = parent;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const float* const own = skin->bones[i].inverse_bind.origin;
    const int parent = skeleton->bones[i].parent;
    const float zero[3] = {};
    const float* const above = parent < 0 ? zero : skin->bones[static_cast<std::size_t>(parent)].inverse_bind.origin;
    skeleton->bones[i].position = {above[0] - own[0], above[1] - own[1], above[2] - own[2]};
  }
  return skeleton;
}

// The last message, which is forgotten.
static bool says(const char* text) {
  const bool is_there = errors.size() == 1 && errors[0].find(text) != std::string::npos;
  if (is_there) errors.clear();
  return is_there;
}

static std::size_t faults(Node* body) {
  Variant list = call(body, "penetrations", {});
  const std::size_t count = items_of(list).size();
  destroy(list);
  return count;
}

int main(int argc, char** argv) {
  require(argc == 4, "trial LIBRARY ASSET COPY");
  using Entry = uint8_t (*)(FunctionLookup, void*, Initialization*);
  const Entry entry = reinterpret_cast<Entry>(entry_of(argv[1]));
  require(entry != nullptr, "the library has its entry");
  int token = 0;
  Initialization initialization{};
  require(entry([](const char*) -> void* { return nullptr; }, &token, &initialization) == 0,
          "an older Godot is refused");
  require(entry(get_proc_address, &token, &initialization) == 1, "the entry succeeds");
  require(initialization.minimum_level == kLevelScene, "it is initialized with the scene");
  for (int32_t level = 0; level < 4; ++level) initialization.initialize(initialization.userdata, level);
  require(classes.size() == 2, "two classes are registered");
  require(classes.at("SpherechainBody").methods.at("bind").argument_class == "Skeleton3D", "bind() takes a Skeleton3D");
  require(classes.at("SpherechainBody").methods.at("load").argument == kString, "load() takes a String");

  // In the copy a bone is called as some programs do, with a colon. Godot's importers make an underscore of it.
  std::ifstream file(argv[2], std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(file), {});
  const std::size_t at = bytes.find("left_elbow");
  require(at != std::string::npos, "the trial's asset has a left_elbow");
  bytes[at + 4] = ':';
  std::ofstream copy(argv[3], std::ios::binary);
  copy << bytes;
  copy.close();
  const spherechain::Model model(bytes.data(), bytes.size(), nullptr, 0, SC_LAYOUT_UNSET);
  require(static_cast<bool>(model), model.message());
  Node* const skeleton = make_skeleton(model);

  // Mistakes are reported, and change nothing.
  Node* const body = make("SpherechainBody");
  Node* const response = make("SpherechainResponse");
  call(body, "load", {}, kTooFewArguments);
  call(body, "load", {of_int(3)}, kInvalidArgument);
  call(body, "penetrations", {of_int(3)}, kTooManyArguments);
  require(errors.empty(), "calls with wrong arguments do not reach the class");
  require(int_of(call(body, "bind", {of_node(skeleton)})) == 0 && says("load() an asset"), "bind() before load()");
  require(int_of(call(body, "load", {of_text("no such file")})) == 0 && says("no such file"),
          "a file that is not there");
  require(int_of(call(body, "load", {of_text(argv[1])})) == 0 && says("no sphere chain asset"),
          "a file that is no asset");
  require(faults(body) == 0 && says("bind() a skeleton"), "penetrations() before bind()");

  Variant path = of_text(argv[3]);
  const void* const string = reinterpret_cast<const char*>(&path) + 8;  // the String within
  Bool is_loaded = 0;
  call_typed(body, "load", string, &is_loaded);
  destroy(path);
  require(is_loaded == 1, "load()");
  require(int_of(call(body, "bind", {of_node(nullptr)})) == 0 && says("pass a Skeleton3D"), "bind() of null");
  require(int_of(call(body, "bind", {of_node(skeleton->children[0])})) == 0 && says("pass a Skeleton3D"),
          "bind() of another node");
  const std::string own_name = skeleton->bones[3].name;
  skeleton->bones[3].name = skeleton->children[1]->skin->bones[3].name = "another";
  require(int_of(call(body, "bind", {of_node(skeleton)})) == 0 && says(own_name.c_str()),
          "bind() names the bone that lacks");
  skeleton->bones[3].name = skeleton->children[1]->skin->bones[3].name = own_name;
  skeleton->children[1]->skin->bones[3].inverse_bind.origin[0] += 1000;
  require(int_of(call(body, "bind", {of_node(skeleton)})) == 0 && says("inverse bind"),
          "bind() compares the skin's matrices");
  skeleton->children[1]->skin->bones[3].inverse_bind.origin[0] -= 1000;
  require(int_of(call(response, "bind", {of_node(body)})) == 0 && says("is bound to a skeleton"),
          "a response of no skeleton");

  Bool is_bound = 0;
  call_typed(body, "bind", &skeleton, &is_bound);
  require(is_bound == 1, "bind()");
  require(faults(body) == 0, "there is no fault at rest");

  // An arm is turned until it goes into the body.
  Node::Bone* arm = nullptr;
  for (Node::Bone& bone : skeleton->bones) {
    if (bone.name == "left_shoulder") arm = &bone;
  }
  require(arm != nullptr, "the trial's asset has a left_shoulder");
  for (float angle = 0; angle < 2 && faults(body) == 0; angle += 0.05f) {
    for (float side : {-1.0f, 1.0f}) {
      const float sin = side * std::sin(angle / 2);
      arm->rotation = {0.36f * sin, 0.48f * sin, 0.8f * sin, std::cos(angle / 2)};
      if (faults(body) > 0) break;
    }
  }
  Array found;
  Variant empty = call(body, "penetrations", {});
  std::memcpy(&found, empty.bytes + 8, sizeof found);  // an Array that the script made
  call_typed(body, "penetrations", nullptr, &found);
  std::memcpy(empty.bytes + 8, &found, sizeof found);
  require(!items_of(empty).empty(), "the arm goes in");
  Variant first = items_of(empty)[0];
  for (const char* key : {"part", "other", "kind", "bone", "depth", "position", "direction", "distance"})
    item_of(first, key);
  require(float_of(item_of(first, "depth")) > 0 && text_of(item_of(first, "kind")).size() > 4, "depth and kind");
  std::printf("%s in %s (%s), %.1f %% of the height; move %s\n", text_of(item_of(first, "part")).c_str(),
              text_of(item_of(first, "other")).c_str(), text_of(item_of(first, "kind")).c_str(),
              100 * float_of(item_of(first, "depth")) / model.info().height,
              skeleton->bones.at(static_cast<std::size_t>(int_of(item_of(first, "bone")))).name.c_str());
  destroy(empty);

  // The response brings it out.
  require(int_of(call(response, "apply", {of_float(0.03)})) == 0 && says("bind() a body"), "apply() before bind()");
  require(int_of(call(response, "bind", {of_node(skeleton)})) == 0 && says("pass a SpherechainBody"),
          "bind() of no body");
  require(int_of(call(response, "bind", {of_node(response)})) == 0 && says("pass a SpherechainBody"),
          "bind() of itself");
  require(int_of(call(response, "bind", {of_node(body)})) == 1, "bind() of the body");
  int64_t turned = 0;
  const double seconds = 1 / 30.0;
  const Quaternion animated = arm->rotation;
  for (int frame = 0; frame < 40; ++frame) {  // the arm is animated
    arm->rotation = animated;
    call_typed(response, "apply", &seconds, &turned);
  }
  const float expected = arm->rotation.z;
  arm->rotation = animated;
  call(response, "reset", {});
  for (int frame = 0; frame < 40; ++frame) call_typed(response, "apply", &seconds, &turned);
  require(std::abs(arm->rotation.z - expected) < 1e-4f, "corrections of a pose that stays do not add up");
  require(int_of(call(response, "apply", {of_int(0)})) > 0, "apply() turns bones");
  require(turned > 0 && faults(body) == 0, "the response brings the arm out");
  call(response, "reset", {});
  std::printf("the response turns %d bones: no fault is left\n", static_cast<int>(turned));
  require(errors.empty(), "nothing else was reported");

  // A body that is bound again needs a new response; a skeleton may go.
  require(int_of(call(body, "bind", {of_node(skeleton)})) == 1, "bind() again");
  require(int_of(call(response, "apply", {of_float(0.03)})) == 0 && says("again after"),
          "apply() after the body's bind()");
  require(int_of(call(response, "bind", {of_node(body)})) == 1, "bind() of the body again");
  require(int_of(call(body, "load", {of_text(argv[3])})) == 1, "load() again");
  require(int_of(call(response, "apply", {of_float(0.03)})) == 0 && says("again after"),
          "apply() after the body's load()");
  require(int_of(call(body, "bind", {of_node(skeleton)})) == 1, "bind() after load()");
  require(int_of(call(response, "bind", {of_node(body)})) == 1, "bind() of the body once more");
  require(body->references == 2, "a response keeps its body");
  forget(skeleton);
  require(faults(body) == 0 && says("bind() a skeleton"), "penetrations() of a freed skeleton");
  require(int_of(call(response, "apply", {of_float(0.03)})) == 0 && says("bind() a body"),
          "apply() to a freed skeleton");
  Variant last_response = of_node(response), last_body = of_node(body);
  --response->references;  // the script's variables end here
  --body->references;
  destroy(last_response);
  destroy(last_body);
  for (int32_t level = 3; level >= 0; --level) initialization.deinitialize(initialization.userdata, level);
  require(classes.empty(), "the classes are unregistered");
  require(errors.empty(), "nothing else was reported");
  std::printf("%d values are alive\n", static_cast<int>(alive));
  return alive == 0 ? 0 : 1;
}
