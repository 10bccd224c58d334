// SPDX-License-Identifier: MIT
// duel ASSET.sphc MODEL.glb: two fighters of one model play its clip face to face, half a clip apart. Who hits whom,
// when, where and how deep? And whose foot goes through the floor?
#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "gltf_pose.h"
#include "spherechain/spherechain.h"

using namespace spherechain;

namespace {

constexpr double kFrame = 1.0 / 30;
constexpr float kDistance = 0.3F;  // of the height, from one fighter's origin to the other's

void check(Status status, const char* what) {
  if (status != SC_OK) {
    throw std::runtime_error(std::string(what) + ": " + sc_field_name(status.field) + ": " + sc_code_text(status.code));
  }
}

// What all fighters of a model share.
struct Model {
  std::vector<std::uint64_t> bytes;  // the file's, aligned for the asset
  Asset asset;
  AssetInfo info{};
  std::vector<std::uint64_t> skin_table;
  std::vector<std::uint32_t> joint_of_bone;
  const samples::GltfCharacter& clips;

  Model(const std::vector<char>& file, const samples::GltfCharacter& character)
      : bytes(file.size() / 8 + 1), clips(character) {
    char message[256];
    std::copy(file.begin(), file.end(), reinterpret_cast<char*>(bytes.data()));
    check(sc_asset_open(&asset, SC_ABI_VERSION, bytes.data(), file.size(), message, sizeof message), message);
    info = sc_asset_get_info(&asset);
    skin_table.resize(sc_skin_table_words(&asset));
    check(sc_prepare_skin(&asset, skin_table.data(), skin_table.size()), "the asset's skin");
    joint_of_bone.resize(info.bone_count);
    const std::vector<Bone> joints = clips.joints();
    check(sc_bind_joints(&asset, joints.data(), joints.size(), SC_COLUMNS_4X4, joint_of_bone.data(), info.bone_count,
                         message, sizeof message),
          message);
  }
};

class Fighter {
 public:
  // Turned half around the model's own upward axis, or not, and moved along its forward axis.
  Fighter(const Model& model, bool turned, float forward)
      : model_(model), before_(12 * model.info.bone_count), bones_(before_) {
    const Vec3 up = model.info.up, way = model.info.forward;
    place_.translation = {forward * way.x, forward * way.y, forward * way.z};
    place_.scale = {1, 1, 1};
    const float half_turn[4] = {up.x, up.y, up.z, 0}, none[4] = {0, 0, 0, 1};
    std::copy_n(turned ? half_turn : none, 4, place_.rotation);
    body.asset = &model.asset;
    body.skin_table = model.skin_table.data();
    body.pose.bones = bones_.data();
    body.pose.bone_count = model.info.bone_count;
    body.pose.bone_layout = SC_ROWS_3X4;
    step.body = body;
    step.body.pose.bones = before_.data();
    step.end = body.pose;
  }
  Fighter(const Fighter&) = delete;  // body and step point into this

  void stand(double seconds) {
    before_ = bones_;
    const samples::Palette palette = model_.clips.palette(0, seconds);
    const Pose pose = samples::pose_of(palette);
    check(sc_gather_bones(&model_.asset, model_.joint_of_bone.data(), &pose, bones_.data()), "the palette");
    check(sc_place_bones(&place_, bones_.data(), model_.info.bone_count), "the place");
  }

  JobBody body;    // as it stands
  Motion step;  // from where it stood before

 private:
  const Model& model_;
  std::vector<float> before_, bones_;
  Transform place_{};
};

class Referee {
 public:
  explicit Referee(const Model& model)
      : model_(model),
        scratch_(std::max({sc_body_scratch_words(&model.asset, &model.asset), sc_floor_scratch_words(&model.asset),
                           sc_body_penetration_scratch_words(&model.asset, &model.asset, kContacts)})),
        contacts_(kContacts),
        found_(model.info.part_count * model.info.part_count),
        steps_(found_.size()) {}

  // Prints the hits on the way from the last frame to this one.
  void watch(std::size_t frame, const Fighter& red, const Fighter& blue) {
    StepJob job;
    job.a = red.step;
    job.b = blue.step;
    scratch_.resize(std::max(scratch_.size(), sc_step_scratch_words(&job.a, &job.b)));
    job.scratch = scratch_.data();
    job.scratch_words = scratch_.size();
    job.contacts = steps_.data();
    job.contact_capacity = steps_.size();
    check(job.run(), "a step");
    std::sort(steps_.begin(), steps_.begin() + static_cast<std::ptrdiff_t>(job.contact_count),
              [](const StepContact& l, const StepContact& r) { return l.begin < r.begin; });
    std::vector<Penetration> depths;
    for (std::size_t i = 0; i < job.contact_count; ++i) {
      const StepContact& hit = steps_[i];
      if (hit.at_start != 0) continue;  // not a new one
      ++hits;
      const double before = static_cast<double>(frame) - 1;
      std::printf("frame %.2f: red's %s meets blue's %s at (%.2f, %.2f, %.2f)", before + double{hit.begin},
                  name(hit.part_a), name(hit.part_b), double{hit.at.x}, double{hit.at.y}, double{hit.at.z});
      if (hit.at_end == 0) {
        ++passing;
        std::printf(" and leaves it at %.2f\n", before + double{hit.end});
        continue;
      }
      if (depths.empty()) depths = measure(red.body, blue.body);
      for (const Penetration& depth : depths) {
        if (depth.part != hit.part_a || depth.other != hit.part_b) continue;
        const double metres = double{depth.measures.depth * model_.info.metres_per_unit};
        std::printf(", %.0f mm deep in frame %zu", 1000 * metres, frame);
      }
      std::printf("\n");
    }
  }

  // How far a fighter is below the floor at most, in metres.
  double below_floor(const Fighter& fighter) {
    FloorJob job;
    job.body = fighter.body;
    job.up = model_.info.up;
    job.scratch = scratch_.data();
    job.scratch_words = scratch_.size();
    job.penetrations = found_.data();
    job.penetration_capacity = found_.size();
    check(job.run(), "the floor");
    float deepest = 0;
    for (std::size_t i = 0; i < job.penetration_count; ++i) deepest = std::max(deepest, found_[i].measures.depth);
    return double{deepest * model_.info.metres_per_unit};
  }

  std::size_t hits = 0, passing = 0;

 private:
  static constexpr std::size_t kContacts = 1 << 16;

  std::vector<Penetration> measure(const JobBody& a, const JobBody& b) {
    BodyContactJob find;
    find.a = a;
    find.b = b;
    find.scratch = scratch_.data();
    find.scratch_words = scratch_.size();
    find.triangles = contacts_.data();
    find.triangle_capacity = contacts_.size();
    check(find.run(), "contacts");
    BodyPenetrationJob job;
    job.a = a;
    job.b = b;
    job.contacts = contacts_.data();
    job.contact_count = find.triangle_count;
    job.scratch = scratch_.data();
    job.scratch_words = scratch_.size();
    job.penetrations = found_.data();
    job.penetration_capacity = found_.size();
    check(job.run(), "penetrations");
    return {found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(job.penetration_count)};
  }
  const char* name(std::uint32_t part) const { return sc_asset_part(&model_.asset, part).name; }

  const Model& model_;
  std::vector<std::uint64_t> scratch_;
  std::vector<TriangleContact> contacts_;
  std::vector<Penetration> found_;
  std::vector<StepContact> steps_;
};

void fight(const std::vector<char>& file, const samples::GltfCharacter& clips) {
  if (clips.clip_count() == 0) throw std::runtime_error("the model has no clip");
  const Model model(file, clips);
  Fighter red(model, false, 0), blue(model, true, kDistance * model.info.height);
  Referee referee(model);
  const double duration = clips.duration(0);
  std::size_t frames = 0;
  double deepest = 0;
  for (double now = 0; now <= duration; now += kFrame, ++frames) {
    red.stand(now);
    blue.stand(now < duration / 2 ? now + duration / 2 : now - duration / 2);
    if (frames > 0) referee.watch(frames, red, blue);
    deepest = std::max({deepest, referee.below_floor(red), referee.below_floor(blue)});
  }
  std::printf("%zu frames, %zu hits, %zu of them between two frames; below the floor by %.0f mm at most\n", frames,
              referee.hits, referee.passing, 1000 * deepest);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: duel ASSET.sphc MODEL.glb\n", stderr);
    return 2;
  }
  try {
    const std::vector<char> file = samples::read_file(argv[1]);
    fight(file, samples::GltfCharacter(argv[2]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "duel: error: %s\n", error.what());
    return 3;
  }
  return 0;
}
