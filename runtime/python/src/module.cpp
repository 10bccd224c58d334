// SPDX-License-Identifier: MIT
// The module spherechain._native: arrays in and out.
#include "model.h"
#include "parallel.h"
#include "spherechain/version.h"

namespace spherechain::python {
namespace {

template <typename Entry>
py::list list_of(std::size_t count, const Entry& entry) {
  py::list out;
  for (std::size_t i = 0; i < count; ++i) {
    out.append(entry(i));
  }
  return out;
}

py::tuple tuple_of(const Vec3& v) { return py::make_tuple(v.x, v.y, v.z); }

// The attributes of spherechain.Model by their names; what Python wraps has a name of its own.
py::dict info(const LoadedModel& model) {
  const Asset& asset = model.asset();
  const AssetInfo& from = model.info();
  const std::uint32_t* const joints = model.joint_of_bone();
  py::dict out;
  out["sphere_count"] = from.sphere_count;
  out["vertex_count"] = from.vertex_count;
  out["triangle_count"] = from.triangle_count;
  out["height"] = from.height;
  out["metres_per_unit"] = from.metres_per_unit;
  out["left"] = tuple_of(from.left);
  out["up"] = tuple_of(from.up);
  out["forward"] = tuple_of(from.forward);
  out["source_file"] = from.source_file;
  out["settings"] = from.settings;
  out["morphs"] = list_of(from.morph_count, [&](std::size_t i) { return sc_asset_morph_name(&asset, i); });
  out["regions"] = list_of(from.region_count, [&](std::size_t i) { return sc_asset_region_name(&asset, i); });
  out["bones"] = list_of(from.bone_count, [&](std::size_t i) {
    const Bone bone = sc_asset_bone(&asset, i);
    return py::make_tuple(bone.name, py::array_t<float>({3, 4}, bone.inverse_bind));
  });
  out["parts"] = list_of(from.part_count, [&](std::size_t i) {
    const BodyPart part = sc_asset_part(&asset, i);
    return py::make_tuple(part.name, static_cast<int>(part.side), part.bone, part.parent);
  });
  out["rest_spheres"] = list_of(from.sphere_count, [&](std::size_t i) {
    const sc_rest_sphere s = sc_asset_sphere(&asset, i);
    return py::make_tuple(s.center.x, s.center.y, s.center.z, s.detect_radius);
  });
  out["joint_of_bone"] = list_of(joints == nullptr ? 0 : from.bone_count, [&](std::size_t i) {
    return static_cast<std::int32_t>(joints[i]);  // SC_NO_JOINT becomes -1
  });
  return out;
}

// (part, region, sphere) of a triangle of the source; None: the asset leaves it out.
py::object triangle(const LoadedModel& model, std::uint32_t number) {
  const TriangleOwner owner = model.model().triangle(number);
  return owner.part == SC_NO_PART ? py::object(py::none()) : py::make_tuple(owner.part, owner.region, owner.sphere);
}

}  // namespace
}  // namespace spherechain::python

PYBIND11_MODULE(_native, module) {
  using namespace spherechain;
  using namespace spherechain::python;
  main_thread = py::module_::import("threading").attr("main_thread")().attr("ident").cast<unsigned long>();
  module.attr("VERSION") = SC_VERSION;
  module.attr("RESPONSE_WORDS") = SC_RESPONSE_WORDS;
  module.attr("SIZES") = py::make_tuple(sizeof(Penetration), sizeof(PartContact), sizeof(Pair), sizeof(TriangleContact),
                                        sizeof(StepContact), sizeof(Transform), sizeof(ContactRow));
  py::enum_<Radius>(module, "Radius").value("detect", SC_RADIUS_DETECT).value("fit", SC_RADIUS_FIT);
  py::enum_<Scope>(module, "Scope")
      .value("apart", SC_SCOPE_APART)
      .value("neighbours", SC_SCOPE_NEIGHBOURS)
      .value("all", SC_SCOPE_ALL)
      .value("layers", SC_SCOPE_LAYERS);
  py::enum_<PenetrationClass> kinds(module, "Class");
  for (int kind = SC_CLASS_REST; kind <= SC_CLASS_INSIDE; ++kind) {
    kinds.value(sc_penetration_class_name(static_cast<PenetrationClass>(kind)), static_cast<PenetrationClass>(kind));
  }
  py::class_<LoadedModel> model(module, "Model");
  model
      .def(py::init<const std::string&, const std::optional<std::vector<Joint>>&>(), py::arg("data"),
           py::arg("joints") = py::none())
      .def("info", &info)
      .def("triangle", &triangle);
  define_questions(model);
  define_losses(model);
  define_response(module);
}
