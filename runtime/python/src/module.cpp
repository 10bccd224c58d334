// SPDX-License-Identifier: MIT
// The module spherechain._native: arrays in and out, without the GIL in between. It checks sizes, so that nothing reads
// out of bounds; spherechain/_asset.py checks what people pass, and says it in their words.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <stdexcept>

#include "contacts.h"
#include "energy.h"
#include "pairs.h"
#include "parallel.h"
#include "signals.h"
#include "spherechain/version.h"

namespace py = pybind11;

namespace spherechain::python {
namespace {

template <typename T>
using Array = py::array_t<T>;  // of any strides

void require(bool is_so, const char* what) {
  if (!is_so) {
    throw std::invalid_argument(what);
  }
}

Radius radius_of(int radius) {
  require(radius == SC_RADIUS_DETECT || radius == SC_RADIUS_FIT, "radius");
  return static_cast<Radius>(radius);
}

// (poses, bones, 3, 4); rows of four lie side by side, three rows too.
template <typename T>
Poses<T> poses_of(const LoadedAsset& asset, const Array<T>& bones) {
  constexpr py::ssize_t kSize = sizeof(T);
  require(bones.ndim() == 4 && bones.shape(2) == 3 && bones.shape(3) == 4, "bones: not (poses, bones, 3, 4)");
  require(static_cast<std::size_t>(bones.shape(1)) == asset.info().bone_count && asset.info().bone_count > 0,
          "bones: another number of bones than the asset has");
  const bool lies_well = bones.strides(3) == kSize && bones.strides(2) == 4 * kSize && bones.strides(1) >= 12 * kSize &&
                         bones.strides(1) % kSize == 0 && bones.strides(0) >= 0 && bones.strides(0) % kSize == 0;
  require(lies_well || bones.size() == 0, "bones: strides");
  return {bones.data(), static_cast<std::size_t>(bones.shape(0)), static_cast<std::size_t>(bones.strides(0)) / kSize,
          static_cast<std::size_t>(bones.strides(1)) / kSize};
}

// An array in C order of exactly this shape.
template <typename T>
T* checked(const Array<T>& array, std::initializer_list<std::size_t> shape, const char* name) {
  bool is_so = static_cast<std::size_t>(array.ndim()) == shape.size() && (array.flags() & py::array::c_style) != 0;
  py::ssize_t axis = 0;
  for (const std::size_t size : shape) {
    is_so = is_so && static_cast<std::size_t>(array.shape(axis++)) == size;
  }
  if (!is_so) {
    throw std::invalid_argument(std::string(name) + ": another shape or order");
  }
  return const_cast<T*>(array.data());
}

// Null where None.
const float* optional_rows(const py::object& object, std::size_t count, std::size_t size, const char* name) {
  return object.is_none() ? nullptr : checked(object.cast<Array<float>>(), {count, size}, name);
}

template <typename T>
Array<T> make(std::initializer_list<std::size_t> shape) {
  return Array<T>(std::vector<py::ssize_t>(shape.begin(), shape.end()));
}

// Bytes that own a vector's entries, for a view by a dtype; no copy.
template <typename T>
py::array_t<std::uint8_t> bytes_of(std::vector<T>&& entries) {
  auto* const kept = new std::vector<T>(std::move(entries));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<T>*>(p); });
  return py::array_t<std::uint8_t>({static_cast<py::ssize_t>(kept->size() * sizeof(T))}, {1},
                                   reinterpret_cast<const std::uint8_t*>(kept->data()), owner);
}

py::array_t<float> spheres(const LoadedAsset& asset, const Array<float>& bones, int radius, std::size_t threads) {
  const Poses<float> poses = poses_of(asset, bones);
  py::array_t<float> out = make<float>({poses.count, asset.info().sphere_count, 4});
  auto* const to = reinterpret_cast<Sphere*>(out.mutable_data());
  const py::gil_scoped_release release;
  for_each_pose(poses.count, threads, [&] {
    return [&](std::size_t i) { refit(asset, radius_of(radius), poses, i, to + i * asset.info().sphere_count); };
  });
  return out;
}

py::tuple pairs(const LoadedAsset& asset, const Array<float>& bones, int radius, std::size_t threads) {
  const Poses<float> poses = poses_of(asset, bones);
  const std::size_t sphere_count = asset.info().sphere_count;
  std::vector<std::vector<Pair>> lists(poses.count);
  std::vector<Pair> all;
  std::vector<std::size_t> first{0};
  {
    const py::gil_scoped_release release;
    for_each_pose(poses.count, threads, [&] {
      return [&, finder = PairFinder(asset, radius_of(radius)),
              spheres = std::vector<Sphere>(sphere_count)](std::size_t i) mutable {
        refit(asset, radius_of(radius), poses, i, spheres.data());
        const Span<const Pair> found = finder.find(spheres.data());
        lists[i].assign(found.begin(), found.end());
      };
    });
    for (const std::vector<Pair>& list : lists) {
      all.insert(all.end(), list.begin(), list.end());
      first.push_back(all.size());
    }
  }
  return py::make_tuple(bytes_of(std::move(all)), bytes_of(std::move(first)));
}

// Poses of a batch by bones, morph weights and vertices, with the arrays that they lie in.
struct GivenPoses {
  SkinPoses poses;
  Array<float> kept;
};

// (bones, vertices, morph_weights), each an array or None.
GivenPoses skin_poses_of(const LoadedAsset& asset, const py::tuple& given) {
  GivenPoses out;
  if (!given[0].is_none()) {
    out.kept = given[0].cast<Array<float>>();
    out.poses.bones = poses_of(asset, out.kept);
    out.poses.count = out.poses.bones.count;
    out.poses.morph_weights = optional_rows(given[2], out.poses.count, asset.info().morph_count, "morph_weights");
  } else {
    out.kept = given[1].cast<Array<float>>();
    out.poses.count = out.kept.ndim() == 3 ? static_cast<std::size_t>(out.kept.shape(0)) : 0;
    out.poses.vertices = checked(out.kept, {out.poses.count, asset.info().vertex_count, 3}, "vertices");
  }
  return out;
}

Rule rule_of(const std::vector<float>& figures) {
  Rule rule = sc_default_rule();
  float* const own = &rule.touch_depth;
  require(figures.size() == (sizeof(Rule) - sizeof rule.version) / sizeof(float), "rule");
  std::copy(figures.begin(), figures.end(), own);
  return rule;
}

// A query's words of bits: None, or at least so many.
const std::uint64_t* words_of(const py::object& given, std::size_t bits) {
  if (given.is_none()) {
    return nullptr;
  }
  const auto words = given.cast<Array<std::uint64_t>>();
  require(static_cast<std::size_t>(words.size()) >= (bits + 63) / 64, "bits");
  return checked(words, {static_cast<std::size_t>(words.size())}, "bits");
}

// `query` has the numbers and bits of an sc_query; `other` and the poses beside it are None where they are not asked
// for.
py::tuple ask_all(const LoadedAsset& asset, int question, const py::tuple& poses, const py::dict& query,
                  const LoadedAsset* other, const py::object& others, const py::object& before,
                  const py::object& others_before, std::size_t threads) {
  Asked asked;
  asked.question = static_cast<Question>(question);
  asked.other = other;
  const GivenPoses given = skin_poses_of(asset, poses);
  GivenPoses more[3];
  const auto take = [&](const LoadedAsset& of, const py::object& from, GivenPoses& kept) {
    if (!from.is_none()) {
      kept = skin_poses_of(of, from.cast<py::tuple>());
      require(kept.poses.count == given.poses.count, "poses: another number");
    }
    return kept.poses;
  };
  asked.others = take(other == nullptr ? asset : *other, others, more[0]);
  asked.before = take(asset, before, more[1]);
  asked.others_before = take(other == nullptr ? asset : *other, others_before, more[2]);
  const bool is_step = asked.question == Question::kSteps;
  require((other != nullptr) == (asked.others.count > 0 || (other != nullptr && given.poses.count == 0)), "others");
  require(!is_step || given.poses.count == asked.before.count, "before");
  require(!is_step || other == nullptr || given.poses.count == asked.others_before.count, "others_before");

  Query& q = asked.query;
  const std::size_t parts = asset.info().part_count, of_other = (other == nullptr ? asset : *other).info().part_count;
  q.scope = static_cast<Scope>(query["scope"].cast<int>());
  q.detail = static_cast<Detail>(query["detail"].cast<int>());
  q.classes = query["classes"].cast<std::uint32_t>();
  q.limit = query["limit"].cast<std::size_t>();
  q.tolerance = query["tolerance"].cast<float>();
  q.ignored_parts = words_of(query["ignored_parts"], parts);
  q.ignored_parts_of_other = words_of(query["ignored_parts_of_other"], of_other);
  q.part_pairs = words_of(query["part_pairs"], parts * of_other);
  std::vector<std::uint64_t> ignored;
  Filter filter;
  if (!query["ignored_spheres"].is_none()) {
    ignored.resize(sc_pair_words(&asset.asset()));
    filter = {ignored.data(), ignored.size()};
    python::require(sc_reset_filter(&asset.asset(), &filter));
    for (const auto& [a, b] : query["ignored_spheres"].cast<std::vector<std::pair<std::uint32_t, std::uint32_t>>>()) {
      python::require(sc_ignore_pair(&asset.asset(), &filter, a, b, 1));
    }
    q.filter = &filter;
  }
  Rule rule;
  if (!query["rule"].is_none()) {
    rule = rule_of(query["rule"].cast<std::vector<float>>());
    q.rule = &rule;
  }
  const auto up = query["up"].cast<std::array<float, 3>>();
  asked.ground.up = {up[0], up[1], up[2]};
  asked.ground.height = query["height"].cast<float>();
  Answers found;
  {
    const py::gil_scoped_release release;
    found = ask(asset, given.poses, asked, threads);
  }
  py::list lists;
  for (Runs& runs : found.lists) {
    lists.append(py::make_tuple(bytes_of(std::move(runs.bytes)), bytes_of(std::move(runs.first))));
  }
  return py::make_tuple(lists, bytes_of(std::move(found.totals)));
}

template <typename T>
py::tuple pair_energy_of(const LoadedAsset& asset, const Array<T>& spheres, int radius, std::size_t threads) {
  const std::size_t count = spheres.ndim() == 3 ? static_cast<std::size_t>(spheres.shape(0)) : 0;
  const T* const from = checked(spheres, {count, asset.info().sphere_count, 4}, "spheres");
  py::array_t<T> energy = make<T>({count}), gradient = make<T>({count, asset.info().sphere_count, 4});
  T *const energies = energy.mutable_data(), *const gradients = gradient.mutable_data();
  {
    const py::gil_scoped_release release;
    pair_energy(asset, radius_of(radius), from, count, threads, energies, gradients);
  }
  return py::make_tuple(energy, gradient);
}

template <typename T>
py::tuple sphere_energy_of(const LoadedAsset& asset, const Array<T>& bones, int radius, std::size_t threads) {
  const Poses<T> poses = poses_of(asset, bones);
  py::array_t<T> energy = make<T>({poses.count}), gradient = make<T>({poses.count, asset.info().bone_count, 3, 4});
  T *const energies = energy.mutable_data(), *const gradients = gradient.mutable_data();
  {
    const py::gil_scoped_release release;
    sphere_energy(asset, radius_of(radius), poses, threads, energies, gradients);
  }
  return py::make_tuple(energy, gradient);
}

template <typename T>
py::array_t<T> spheres_vjp(const LoadedAsset& asset, const Array<T>& bones, const Array<T>& slopes, int radius,
                           std::size_t threads) {
  const Poses<T> poses = poses_of(asset, bones);
  const T* const from = checked(slopes, {poses.count, asset.info().sphere_count, 4}, "gradient");
  py::array_t<T> gradient = make<T>({poses.count, asset.info().bone_count, 3, 4});
  T* const to = gradient.mutable_data();
  const py::gil_scoped_release release;
  pull_back_spheres(asset, radius_of(radius), poses, from, threads, to);
  return gradient;
}

template <typename T>
py::array_t<T> skin_points(const LoadedAsset& asset, const Array<T>& bones, const Array<std::uint32_t>& triangles,
                           const Array<float>& weights, const py::object& morph_weights, std::size_t threads) {
  const Poses<T> poses = poses_of(asset, bones);
  const auto count = static_cast<std::size_t>(triangles.size());
  const SkinPoints points{checked(triangles, {count}, "triangles"), checked(weights, {count, 3}, "weights"), count};
  const float* const morphs = optional_rows(morph_weights, poses.count, asset.info().morph_count, "morph_weights");
  py::array_t<T> out = make<T>({poses.count, count, 3});
  T* const to = out.mutable_data();
  const py::gil_scoped_release release;
  place_points(asset, poses, morphs, points, threads, to);
  return out;
}

// Throws with the message of sc_check_rest() for the first pose that is no rest pose.
void check_rest(const LoadedAsset& asset, const Array<float>& bones) {
  const Poses<float> poses = poses_of(asset, bones);
  for (std::size_t i = 0; i < poses.count; ++i) {
    const Pose pose = pose_of(asset, poses, i);
    char message[512] = "";
    if (sc_check_rest(asset.model().handle(), &pose, message, sizeof message) != SC_OK) {
      throw std::invalid_argument(message);
    }
  }
}

// (part, region, sphere) of a triangle of the source; None: the asset leaves it out.
py::object triangle(const LoadedAsset& asset, std::uint32_t number) {
  const TriangleOwner owner = asset.model().triangle(number);
  return owner.part == SC_NO_PART ? py::object(py::none()) : py::make_tuple(owner.part, owner.region, owner.sphere);
}

std::vector<float> default_rule() {
  const Rule rule = sc_default_rule();
  return {&rule.touch_depth, &rule.touch_depth + (sizeof(Rule) - sizeof rule.version) / sizeof(float)};
}

// `penetrations`: bytes; `first`: where each pose's start, and their end.
py::array_t<float> depth_gradients(const LoadedAsset& asset, const Array<std::uint8_t>& penetrations,
                                   const Array<std::uint64_t>& first, const Array<float>& slopes,
                                   const py::object& morph_weights) {
  const auto size = static_cast<std::size_t>(penetrations.size());
  const auto run_count = static_cast<std::size_t>(first.size());
  const std::size_t count = size / sizeof(Penetration), pose_count = run_count - 1;
  const std::uint8_t* const bytes = checked(penetrations, {count * sizeof(Penetration)}, "contacts");
  const float* const slope = checked(slopes, {count}, "slopes");
  const std::uint64_t* const runs = checked(first, {run_count}, "first");
  require(run_count > 0, "first");
  for (std::size_t i = 0; i < pose_count; ++i) {
    require(runs[i] <= runs[i + 1] && runs[i + 1] <= count, "first");
  }
  const float* const morphs = optional_rows(morph_weights, pose_count, asset.info().morph_count, "morph_weights");
  py::array_t<float> out = make<float>({pose_count, asset.info().bone_count, 3, 4});
  float* const to = out.mutable_data();
  const py::gil_scoped_release release;
  std::fill(to, to + pose_count * asset.info().bone_count * 12, 0.0F);
  add_depth_gradients(asset, reinterpret_cast<const Penetration*>(bytes), slope, runs, pose_count, morphs, to);
  return out;
}

// What a pair's radii are multiplied by: 0 where it is ignored, a rest pair's rest_scale, else 1.
py::array_t<float> pair_scales(const LoadedAsset& asset, int radius) {
  const std::size_t count = asset.info().sphere_count;
  const Span<const std::uint64_t> ignored = asset.view().ignored();
  py::array_t<float> out = make<float>({count, count});
  float* const to = out.mutable_data();
  const auto set = [&](std::size_t a, std::size_t b, float scale) { to[a * count + b] = to[b * count + a] = scale; };
  for (std::size_t b = 0, bit = 0; b < count; ++b) {
    set(b, b, 0);
    for (std::size_t a = 0; a < b; ++a, ++bit) {
      set(a, b, (ignored[bit / 64] >> bit % 64 & 1) == 0 ? 1.0F : 0.0F);
    }
  }
  for (const RestPair& pair : asset.view().rest_pairs(radius_of(radius))) {
    set(pair.a, pair.b, pair.rest_scale * to[pair.a * count + pair.b]);
  }
  return out;
}

py::dict info(const LoadedAsset& asset) {
  const AssetInfo& from = asset.info();
  const auto vec = [](const Vec3& v) { return py::make_tuple(v.x, v.y, v.z); };
  const auto list = [](std::size_t count, const auto& entry) {
    py::list out;
    for (std::size_t i = 0; i < count; ++i) {
      out.append(entry(i));
    }
    return out;
  };
  py::dict out;
  out["sphere_count"] = from.sphere_count;
  out["vertex_count"] = from.vertex_count;
  out["triangle_count"] = from.triangle_count;
  out["height"] = from.height;
  out["metres_per_unit"] = from.metres_per_unit;
  out["left"] = vec(from.left);
  out["up"] = vec(from.up);
  out["forward"] = vec(from.forward);
  out["source_file"] = from.source_file;
  out["settings"] = from.settings;
  out["bones"] = list(from.bone_count, [&](std::size_t i) {
    const sc_bone bone = sc_asset_bone(&asset.asset(), i);
    return py::make_tuple(bone.name, py::array_t<float>({3, 4}, bone.inverse_bind));
  });
  out["parts"] = list(from.part_count, [&](std::size_t i) {
    const sc_part part = sc_asset_part(&asset.asset(), i);
    return py::make_tuple(part.name, static_cast<int>(part.side), part.bone, part.parent);
  });
  out["morphs"] = list(from.morph_count, [&](std::size_t i) { return sc_asset_morph_name(&asset.asset(), i); });
  out["spheres"] = list(from.sphere_count, [&](std::size_t i) {
    const sc_rest_sphere s = sc_asset_sphere(&asset.asset(), i);
    return py::make_tuple(s.center.x, s.center.y, s.center.z, s.radius, s.detect_radius);
  });
  return out;
}

std::string class_name(int kind) { return sc_penetration_class_name(static_cast<PenetrationClass>(kind)); }

// What float and double both have: the caller's type of number decides.
template <typename T>
void define_for(py::class_<LoadedAsset>& asset) {
  const auto exact = [](const char* name) { return py::arg(name).noconvert(); };
  const auto radius = py::arg("radius"), threads = py::arg("threads");
  asset.def("pair_energy", &pair_energy_of<T>, exact("spheres"), radius, threads);
  asset.def("sphere_energy", &sphere_energy_of<T>, exact("bones"), radius, threads);
  asset.def("spheres_vjp", &spheres_vjp<T>, exact("bones"), exact("gradient"), radius, threads);
  asset.def("points", &skin_points<T>, exact("bones"), py::arg("triangles"), py::arg("weights"),
            py::arg("morph_weights"), threads);
}

}  // namespace
}  // namespace spherechain::python

PYBIND11_MODULE(_native, module) {
  using namespace spherechain;
  using namespace spherechain::python;
  module.attr("PENETRATION_BYTES") = sizeof(Penetration);
  module.attr("TRIANGLE_BYTES") = sizeof(TriangleContact);
  module.attr("VERSION") = SC_VERSION;
  set_main_thread(py::module_::import("threading").attr("main_thread")().attr("ident").cast<unsigned long>());
  module.attr("STEP_BYTES") = sizeof(StepContact);
  module.attr("CONTACT_BYTES") = sizeof(PartContact);
  module.def("class_name", &class_name);
  module.def("default_rule", &default_rule);
  py::class_<LoadedAsset> asset(module, "Model");
  asset.def(py::init<const std::string&>())
      .def("bytes", [](const LoadedAsset& self) { return py::bytes(self.bytes()); })
      .def("info", &info)
      .def("check_rest", &check_rest)
      .def("pair_scales", &pair_scales)
      .def("spheres", &spheres)
      .def("pairs", &pairs)
      .def("ask", &ask_all)
      .def("triangle", &triangle)
      .def("depth_gradients", &depth_gradients);
  define_for<float>(asset);
  define_for<double>(asset);
}
