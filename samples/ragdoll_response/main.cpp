// SPDX-License-Identifier: MIT
// ragdoll_response ASSET: a hand that is inside the chest is pushed out by the contact data. Each contact says how far
// its sphere must go and which way; the joints above it turn by what that takes, until nothing touches.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

#include "skeleton.h"
#include "spherechain/contacts.h"
#include "spherechain/detect.h"
#include "spherechain/refit_bones.h"

using namespace spherechain;
using samples::Palette;

namespace {

constexpr int kMaxSteps = 200;
constexpr float kSlack = 1.02F;  // a push a little further than to the touch, so that rounding does not leave a rest

int fail(const char* file, const char* what) {
  std::fprintf(stderr, "ragdoll_response: error: %s: %s\n", file, what);
  return 3;
}

Vec3 cross(const Vec3& l, const Vec3& r) {
  return {l.y * r.z - l.z * r.y, l.z * r.x - l.x * r.z, l.x * r.y - l.y * r.x};
}
float dot(const Vec3& l, const Vec3& r) { return l.x * r.x + l.y * r.y + l.z * r.z; }
Vec3 scaled(const Vec3& v, float factor) { return {v.x * factor, v.y * factor, v.z * factor}; }

class Character {
 public:
  explicit Character(const Asset& asset)
      : palette(samples::rest_pose(asset)),
        asset_(asset),
        spheres_(asset.spheres().size),
        pairs_(1024),
        contacts_(pairs_.size()),
        ignored_(Filter::ignored_words(asset)) {
    filter_.ignored = {ignored_.data(), ignored_.size()};
    reset_filter(asset, filter_);
    ignore_hops(asset, filter_, 2);  // a limb that bends nears its own next spheres: a fold, not a contact
  }

  Palette palette;

  // Bones to contacts. What touches in more than 1,024 places comes next time.
  Status update() {
    RefitBonesJob refit;
    refit.asset = &asset_;
    refit.bones = {palette[0].data(), palette.size()};
    refit.spheres = {spheres_.data(), spheres_.size()};
    Status status = refit.run();
    DetectJob detect;
    detect.asset = &asset_;
    detect.spheres = {spheres_.data(), spheres_.size()};
    detect.filter = &filter_;
    detect.pairs = {pairs_.data(), pairs_.size()};
    status = status == Status::kOk ? detect.run() : status;
    contact_count_ = detect.pair_count < pairs_.size() ? detect.pair_count : pairs_.size();
    ContactJob job;
    job.asset = &asset_;
    job.spheres = {spheres_.data(), spheres_.size()};
    job.pairs = {pairs_.data(), contact_count_};
    job.contacts = {contacts_.data(), contacts_.size()};
    status = status == Status::kOk || status == Status::kOverflow ? job.run() : status;
    deepest_ = job.deepest < contact_count_ ? contacts_[job.deepest].depth : 0.0F;
    return status;
  }

  const std::vector<Sphere>& spheres() const { return spheres_; }
  Span<const Contact> contacts() const { return {contacts_.data(), contact_count_}; }
  float deepest() const { return deepest_; }

 private:
  const Asset& asset_;
  std::vector<Sphere> spheres_;
  std::vector<Pair> pairs_;
  std::vector<Contact> contacts_;
  std::vector<std::uint64_t> ignored_;
  Filter filter_;
  std::size_t contact_count_ = 0;
  float deepest_ = 0.0F;
};

// A joint of the arm, and which spheres hang on it.
struct ArmJoint {
  std::size_t index;
  std::vector<bool> moves;
};

// Found by trying: what the joint moves when it turns, it moves.
ArmJoint look_at(const Asset& asset, const char* name) {
  Character character(asset);
  ArmJoint joint{samples::find_joint(asset, name), std::vector<bool>(asset.spheres().size)};
  samples::turn(asset, character.palette, joint.index, {0.1F, 0.1F, 0.1F});
  character.update();
  for (std::size_t i = 0; i < joint.moves.size(); ++i) {
    const Vec3 rest = asset.spheres()[i].center;
    const Sphere& now = character.spheres()[i];
    const Vec3 moved{now.x - rest.x, now.y - rest.y, now.z - rest.z};
    joint.moves[i] = std::sqrt(dot(moved, moved)) > 0.01F * asset.info().height;
  }
  return joint;
}

// Turns the joints above the sphere so that together they move it by `push`.
void push_sphere(const Asset& asset, const std::vector<ArmJoint>& arm, Character& character, std::uint32_t sphere,
                 const Vec3& push) {
  float joints = 0.0F;
  for (const ArmJoint& joint : arm) {
    joints += joint.moves[sphere] ? 1.0F : 0.0F;
  }
  const Sphere& at = character.spheres()[sphere];
  for (const ArmJoint& joint : arm) {
    const Vec3 about = samples::position_of(asset, character.palette, joint.index);
    const Vec3 lever{at.x - about.x, at.y - about.y, at.z - about.z};
    if (joint.moves[sphere] && dot(lever, lever) > 0.0F) {
      samples::turn(asset, character.palette, joint.index,
                    scaled(cross(lever, push), 1.0F / (joints * dot(lever, lever))));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: ragdoll_response ASSET.sphc\n", stderr);
    return 2;
  }
  std::ifstream file(argv[1], std::ios::binary);
  if (!file) {
    return fail(argv[1], "cannot be read");
  }
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  Asset asset;
  char message[160];
  if (asset.open(bytes.data(), bytes.size(), message, sizeof message) != Status::kOk) {
    return fail(argv[1], message);
  }
  const std::vector<const char*> names{"left_shoulder", "left_elbow", "left_wrist"};
  if (!samples::has_automatic_rig(asset) || samples::find_joint(asset, names[0]) == asset.joint_count()) {
    return fail(argv[1], "has no automatic rig with a left arm");
  }
  std::vector<ArmJoint> arm;
  for (const char* name : names) {
    arm.push_back(look_at(asset, name));
  }

  // The forearm across the chest and the hand well into it: a bad animation, or a hit.
  Character character(asset);
  samples::turn(asset, character.palette, "left_wrist", {-8, -29, -28});
  samples::turn(asset, character.palette, "left_elbow", {-48, -40, -14});
  samples::turn(asset, character.palette, "left_shoulder", {-1, -88, -30});

  for (int step = 0; step <= kMaxSteps; ++step) {
    if (const Status status = character.update(); status != Status::kOk) {
      return fail(argv[1], to_string(status));
    }
    const std::size_t count = character.contacts().size;
    std::printf("step %d: %zu pairs touch, the deepest %.2f %% of the height\n", step, count,
                100.0 * static_cast<double>(character.deepest() / asset.info().height));
    if (count == 0) {
      std::printf("free after %d steps\n", step);
      return step > 0 ? 0 : 1;  // nothing to free: the pose above is wrong
    }
    // Only the deepest of those an arm can do something about: the rest looks different after that.
    const Contact* worst = nullptr;
    for (const Contact& contact : character.contacts()) {
      const bool can_move = arm[0].moves[contact.pair.a] != arm[0].moves[contact.pair.b];
      if (can_move && (worst == nullptr || contact.depth > worst->depth)) {
        worst = &contact;
      }
    }
    if (worst == nullptr) {
      break;
    }
    const bool is_a = arm[0].moves[worst->pair.a];
    const float way = (is_a ? -kSlack : kSlack) * worst->depth;  // the normal points from a to b
    push_sphere(asset, arm, character, is_a ? worst->pair.a : worst->pair.b, scaled(worst->normal, way));
  }
  std::fprintf(stderr, "ragdoll_response: error: still touching after %d steps\n", kMaxSteps);
  return 1;
}
