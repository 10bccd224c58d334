// SPDX-License-Identifier: MIT
// The module spherechain._native: arrays in and out.
#include "binding.h"
#include "model.h"
#include "parallel.h"
#include "spherechain/version.h"

namespace spherechain::python {
namespace {

Object vector(const Vec3& v) { return tuple_of(v.x, v.y, v.z); }

// The attributes of spherechain.Model by their names; what Python wraps has a name of its own.
Object info(const LoadedModel& model) {
  const Asset& asset = model.asset();
  const AssetInfo& from = model.info();
  const std::uint32_t* const joints = model.joint_of_bone();
  const Object out = Object::own(PyDict_New());
  set(out, "sphere_count", from.sphere_count);
  set(out, "vertex_count", from.vertex_count);
  set(out, "triangle_count", from.triangle_count);
  set(out, "height", from.height);
  set(out, "metres_per_unit", from.metres_per_unit);
  set(out, "left", vector(from.left));
  set(out, "up", vector(from.up));
  set(out, "forward", vector(from.forward));
  set(out, "source_file", from.source_file);
  set(out, "settings", from.settings);
  set(out, "morphs", list_of(from.morph_count, [&](std::size_t i) { return sc_asset_morph_name(&asset, i); }));
  set(out, "regions", list_of(from.region_count, [&](std::size_t i) { return sc_asset_region_name(&asset, i); }));
  set(out, "bones", list_of(from.bone_count, [&](std::size_t i) {
        const Bone bone = sc_asset_bone(&asset, i);
        const Array<float> inverse_bind({3, 4});
        std::copy(bone.inverse_bind, bone.inverse_bind + 12, inverse_bind.data());
        return tuple_of(bone.name, inverse_bind);
      }));
  set(out, "parts", list_of(from.part_count, [&](std::size_t i) {
        const BodyPart part = sc_asset_part(&asset, i);
        return tuple_of(part.name, static_cast<int>(part.side), part.bone, part.parent);
      }));
  set(out, "rest_spheres", list_of(from.sphere_count, [&](std::size_t i) {
        const sc_rest_sphere s = sc_asset_sphere(&asset, i);
        return tuple_of(s.center.x, s.center.y, s.center.z, s.detect_radius);
      }));
  set(out, "joint_of_bone", list_of(joints == nullptr ? 0 : from.bone_count, [&](std::size_t i) {
        return static_cast<std::int32_t>(joints[i]);  // SC_NO_JOINT becomes -1
      }));
  return out;
}

// (part, region, sphere) of a triangle of the source; None: the asset leaves it out.
Object triangle(const LoadedModel& model, std::uint32_t number) {
  const TriangleOwner owner = model.model().triangle(number);
  return owner.part == SC_NO_PART ? Object::borrow(Py_None) : tuple_of(owner.part, owner.region, owner.sphere);
}

void add(PyObject* module, const char* name, const Object& value) {
  if (PyModule_AddObject(module, name, Object(value).release()) < 0) {
    throw PythonError{};
  }
}

Object numbers(std::initializer_list<std::pair<const char*, int>> names) {
  const Object out = Object::own(PyDict_New());
  for (const auto& [name, number] : names) {
    set(out, name, number);
  }
  return out;
}

void fill(PyObject* module) {
  const Object threading = Object::own(PyImport_ImportModule("threading"));
  const Object thread = Object::own(PyObject_CallMethod(threading.get(), "main_thread", nullptr));
  main_thread = PyLong_AsUnsignedLong(Object::own(PyObject_GetAttrString(thread.get(), "ident")).get());
  add(module, "VERSION", to_python(SC_VERSION));
  add(module, "RESPONSE_WORDS", to_python(SC_RESPONSE_WORDS));
  add(module, "SIZES",
      tuple_of(sizeof(Penetration), sizeof(PartContact), sizeof(Pair), sizeof(TriangleContact), sizeof(StepContact),
               sizeof(Transform), sizeof(ContactRow)));
  add(module, "RADII", numbers({{"detect", SC_RADIUS_DETECT}, {"fit", SC_RADIUS_FIT}}));
  add(module, "SCOPES",
      numbers({{"apart", SC_SCOPE_APART},
               {"neighbours", SC_SCOPE_NEIGHBOURS},
               {"all", SC_SCOPE_ALL},
               {"layers", SC_SCOPE_LAYERS}}));
  const Object classes = numbers({});
  for (int kind = SC_CLASS_REST; kind <= SC_CLASS_INSIDE; ++kind) {
    set(classes, sc_penetration_class_name(static_cast<PenetrationClass>(kind)), kind);
  }
  add(module, "CLASSES", classes);
  static std::vector<PyMethodDef> methods{{"info", Call<&info>::run, METH_VARARGS, nullptr},
                                          {"triangle", Call<&triangle>::run, METH_VARARGS, nullptr}};
  for (const auto* more : {&question_methods, &loss_methods}) {
    methods.insert(methods.end(), more->begin(), more->end());
  }
  methods.push_back({});
  add_class<LoadedModel, Bytes, std::optional<std::vector<Joint>>>(module, "spherechain._native.Model", methods.data());
  add_response(module);
}

}  // namespace
}  // namespace spherechain::python

PyMODINIT_FUNC PyInit__native() {
  using namespace spherechain::python;
  return guarded([]() -> PyObject* {
    static PyModuleDef definition = {
        PyModuleDef_HEAD_INIT, "_native", nullptr, -1, nullptr, nullptr, nullptr, nullptr, nullptr};
    Object module = Object::own(PyModule_Create(&definition));
    fill(module.get());
    return module.release();
  });
}
