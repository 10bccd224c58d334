// SPDX-License-Identifier: MIT
// The response of one character, frame by frame.
#include <array>
#include <atomic>
#include <cstring>
#include <stdexcept>

#include "binding.h"
#include "model.h"

namespace spherechain::python {
namespace {

constexpr std::size_t kFloatsOfJoint = sizeof(Transform) / sizeof(float);

Transform* joints_of(const Array<float>& array, std::size_t count, const char* name) {
  return reinterpret_cast<Transform*>(checked(array, {count, kFloatsOfJoint}, name));
}

// A response with the bodies that it asks.
class LoadedResponse {
 public:
  LoadedResponse(const Object& model_object, const Array<std::uint32_t>& parents,
                 const std::optional<Array<float>>& mobility, const std::optional<Array<float>>& budget,
                 const std::optional<Array<float>>& hinges, const std::optional<Array<std::uint64_t>>& part_pairs,
                 const std::vector<float>& rule, const LoadedModel* largest_other)
      : model_object_(model_object),
        model_(&From<const LoadedModel&>::get(model_object.get())),
        joint_count_(length(parents)) {
    const LoadedModel& model = *model_;
    BodyDef body_def;
    body_def.largest_other = largest_other == nullptr ? nullptr : largest_other->model().handle();
    body_ = Body(model.model(), body_def);
    require(body_.status());
    const std::size_t parts = model.info().part_count;
    const Rule limits = rule_of(rule);
    ResponseDef def;
    def.parents = checked(parents, {joint_count_}, "parents");
    def.joint_count = joint_count_;
    def.mobility = mobility ? checked(*mobility, {joint_count_}, "mobility") : nullptr;
    def.budget = budget ? checked(*budget, {joint_count_}, "budget") : nullptr;
    def.hinges = hinges ? reinterpret_cast<Vec3*>(checked(*hinges, {joint_count_, 3}, "hinges")) : nullptr;
    def.part_pairs = part_pairs ? checked(*part_pairs, {(parts * parts + 63) / 64}, "part_pairs") : nullptr;
    def.rule = &limits;
    response_ = Response(body_, def);
    require(response_.status());
  }

  // `joints` and `state` are replaced. `frame` has the fields of an sc_response_frame by their names; `others` lists
  // (model, poses). Returns (turned, at_budget, remaining, rows as bytes).
  Object respond(const Array<std::uint64_t>& state, const Array<float>& joints, const Object& given) {
    if (is_busy_.test_and_set()) {
      throw std::runtime_error("the response is in use: make one for each thread");
    }
    const Leaving leaving{is_busy_};
    const auto floats = [&](const char* name) { return entry<std::optional<Array<float>>>(given, name); };
    const auto place = floats("place"), morph_weights = floats("morph_weights"), ahead = floats("ahead");
    ResponseFrame frame;
    require(joints.is_writeable(), "joints");
    require(state.is_writeable(), "state");
    frame.joints = joints_of(joints, joint_count_, "joints");
    frame.place = place ? joints_of(*place, 1, "place") : nullptr;
    frame.morph_weights = morphs_of(*model_, morph_weights, 1);
    frame.morph_weight_count = morph_weights ? model_->info().morph_count : 0;
    frame.seconds = entry<float>(given, "seconds");
    frame.weakness = entry<float>(given, "weakness");
    frame.rounds = entry<std::uint32_t>(given, "rounds");
    frame.ahead = ahead ? joints_of(*ahead, joint_count_, "ahead") : nullptr;
    frame.ahead_frames = entry<std::uint32_t>(given, "ahead_frames");
    Ground ground;
    if (const auto plane = entry<std::optional<std::array<float, 4>>>(given, "ground")) {
      ground.up = {(*plane)[0], (*plane)[1], (*plane)[2]};
      ground.height = (*plane)[3];
      frame.ground = &ground;
    }
    std::vector<SkinPoses> poses;  // lives as long as the bodies are asked
    const std::vector<const sc_body*> others =
        take_others(entry<std::vector<std::pair<Object, Object>>>(given, "others"), poses);
    frame.others = others.data();
    frame.other_count = others.size();
    const auto planted = entry<Array<std::uint32_t>>(given, "planted");
    frame.planted_count = length(planted);
    frame.planted = checked(planted, {frame.planted_count}, "planted");

    ResponseState words;
    std::uint64_t* const kept = checked(state, {SC_RESPONSE_WORDS}, "state");
    std::memcpy(words.words, kept, sizeof words.words);
    Status status;
    {
      const WithoutGil others_run;
      status = response_.respond(words, frame);
    }
    require(status);
    std::memcpy(kept, words.words, sizeof words.words);
    return tuple_of(frame.turned, frame.at_budget, frame.remaining,
                    Bytes{{reinterpret_cast<const char*>(frame.rows), frame.row_count * sizeof(ContactRow)}});
  }

 private:
  struct Leaving {
    std::atomic_flag& is_busy;
    ~Leaving() { is_busy.clear(); }
  };
  struct Other {
    Object model;
    Body body;
  };

  std::vector<const sc_body*> take_others(const std::vector<std::pair<Object, Object>>& given,
                                          std::vector<SkinPoses>& poses) {
    std::vector<const sc_body*> out;
    poses.reserve(given.size());
    for (std::size_t i = 0; i < given.size(); ++i) {
      const auto& [model_object, own_poses] = given[i];
      const auto& model = From<const LoadedModel&>::get(model_object.get());
      if (i == others_.size()) {
        others_.emplace_back();
      }
      Other& other = others_[i];
      if (other.model.get() != model_object.get()) {
        other.body = Body();
        other.model = model_object;
        other.body = Body(model.model(), BodyDef());
        require(other.body.status());
      }
      poses.push_back(skin_poses_of(model, own_poses.get()));
      require(poses.back().count == 1, "others");
      require(other.body.set_pose(pose_of(model, poses.back(), 0)));
      out.push_back(other.body.handle());
    }
    return out;
  }

  Object model_object_;  // is kept: the body is of it
  const LoadedModel* model_;
  std::size_t joint_count_;
  std::atomic_flag is_busy_ = ATOMIC_FLAG_INIT;
  Body body_;
  Response response_;  // ends before its body
  std::vector<Other> others_;
};

Object respond(LoadedResponse& response, const Array<std::uint64_t>& state, const Array<float>& joints,
               const Object& frame) {
  return response.respond(state, joints, frame);
}

PyMethodDef methods[] = {{"respond", Call<&respond>::run, METH_VARARGS, nullptr}, {}};

}  // namespace

void add_response(PyObject* module) {
  using Floats = std::optional<Array<float>>;
  add_class<LoadedResponse, Object, Array<std::uint32_t>, Floats, Floats, Floats, std::optional<Array<std::uint64_t>>,
            std::vector<float>, const LoadedModel*>(module, "spherechain._native.Response", methods);
}

}  // namespace spherechain::python
