// SPDX-License-Identifier: GPL-3.0-or-later
// Baked characters and their poses as plain files (pose_file.h), for machines that have a GPU and no baker.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "baker/mesh/error.h"
#include "baker/motion/clip.h"
#include "baker/motion/poses.h"
#include "baker/os/written_file.h"
#include "baker/play/asset_file.h"
#include "baker/play/play.h"
#include "character.h"
#include "pose_file.h"
#include "runtime/src/refit/refit_job.h"

using namespace spherechain;

namespace {

namespace fs = std::filesystem;
using baker::Deformation;

constexpr double kFramesASecond = 30;
constexpr int kFramesMax = 1024, kPoseMotionFrames = 200, kPaperFrames = 40;
constexpr std::size_t kMixedPoses = 1024;  // as spherechain_bench has them

struct Options {
  fs::path out = "out/gpu_data";
  std::vector<fs::path> sources;
};

void append(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}

// From the deformed vertices, of a character without bones of its own.
std::vector<Sphere> refit(const baker::OpenAsset& asset, const baker::Bake& bake, const Deformation& pose) {
  std::vector<float> vertices;
  for (const baker::Vec3& v : baker::deform(bake.character.source_positions, bake.rig_weights, pose.bones)) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) vertices.push_back(static_cast<float>(v[axis]));
  }
  std::vector<Sphere> out(asset->spheres().size);
  RefitJob job;
  job.asset = asset.handle();
  job.pose.vertices = vertices.data();
  job.pose.vertex_count = vertices.size() / 3;
  job.radius = SC_RADIUS_FIT;
  job.spheres = out.data();
  job.sphere_capacity = out.size();
  baker::check_runtime(job.run());
  return out;
}

// NAME.sphc and NAME.poses.
void write(const fs::path& folder, const std::string& name, const baker::Bake& bake,
           const std::vector<Deformation>& poses) {
  const std::string_view bytes(reinterpret_cast<const char*>(bake.asset.data()), bake.asset.size());
  const baker::OpenAsset asset(bytes, name);
  const bool has_moments = asset->refit_rule() == RefitRule::kMoments;
  const std::size_t bones = has_moments ? asset->bone_count() : 0, spheres = has_moments ? 0 : asset->spheres().size;
  const std::uint32_t counts[4] = {static_cast<std::uint32_t>(poses.size()), static_cast<std::uint32_t>(bones),
                                   static_cast<std::uint32_t>(spheres), 0};
  std::string file;
  append(file, bench::kPoseMagic, sizeof bench::kPoseMagic);
  append(file, counts, sizeof counts);
  for (const Deformation& pose : poses) {
    if (has_moments) {
      const std::vector<float> palette = baker::bone_palette(asset, pose);
      append(file, palette.data(), palette.size() * sizeof(float));
    } else {
      const std::vector<Sphere> refitted = refit(asset, bake, pose);
      append(file, refitted.data(), refitted.size() * sizeof(Sphere));
    }
  }
  baker::write_atomically(folder / (name + ".sphc"), bytes);
  baker::write_atomically(folder / (name + ".poses"), file);
  std::printf("%-28s %4zu spheres %4zu bones %5zu poses\n", name.c_str(), asset->spheres().size, bones, poses.size());
}

// Evenly spaced, the start and the end among them.
std::vector<Deformation> frames_of(const baker::Motion& motion, int count) {
  std::vector<Deformation> out;
  out.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) out.push_back(motion.at(static_cast<double>(i) / (count - 1)));
  return out;
}

int frame_count(const baker::Motion& motion) {
  return motion.duration() > 0 ? std::clamp(static_cast<int>(motion.duration() * kFramesASecond) + 1, 2, kFramesMax)
                               : kPoseMotionFrames;
}

// The whole body and the one that the paper covers, each in the benchmarks' poses; the whole body in each clip too.
void write_human(const fs::path& folder) {
  bench::PosedCharacter human, body;
  bench::load(human, "human", "{}", kMixedPoses);
  write(folder, "human", human.bake, human.poses);
  for (const bench::NamedMotion& clip : bench::motions_of(human.bake)) {
    write(folder, "human_" + clip.name, human.bake, frames_of(*clip.motion, frame_count(*clip.motion)));
  }
  bench::load(body, "body", R"({"extremities": false})", kMixedPoses);
  write(folder, "body", body.bake, body.poses);
}

// The paper's two animations on profile `paper`, and on a denser bake of it with about the 80 spheres that it states.
void write_paper(const fs::path& folder) {
  for (const auto& [name, settings] :
       {std::pair("paper", "{}"), std::pair("paper_denser", R"({"penetration_depth": 0.6})")}) {
    const baker::Bake bake = baker::bake(bench::kHuman, baker::make_settings("paper", settings, name), {});
    for (const std::string animation : {"arms", "legs"}) {
      const fs::path file = fs::path(SPHERECHAIN_SAMPLES "/poses") / ("animation_" + animation + ".json");
      const baker::BezierMotion motion(bake.joints, bake.regions.frame, baker::read_pose_motion(file, bake.joints));
      write(folder, std::string(name) + "_" + animation, bake, frames_of(motion, kPaperFrames));
    }
  }
}

// A file with clips of its own, all of them one after another.
void write_source(const fs::path& folder, const fs::path& source) {
  const baker::Bake bake = baker::bake(source, baker::make_settings("balanced", "{}", "balanced"), {});
  std::vector<const baker::Clip*> clips;
  for (const baker::Clip& clip : bake.character.rig.clips) clips.push_back(&clip);
  if (clips.empty()) throw baker::Error(baker::ExitCode::kFile, source.string() + ": has no clip of its own");
  const baker::ClipMotion motion(bake.character.rig, clips);
  write(folder, source.stem().string(), bake, frames_of(motion, frame_count(motion)));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Characters and poses for the measurements on a GPU"};
  Options options;
  app.add_option("-o,--out", options.out, "folder to write")->capture_default_str();
  app.add_option("--source", options.sources, "further files to bake, each with clips of its own");
  CLI11_PARSE(app, argc, argv);
  try {
    fs::create_directories(options.out);
    write_paper(options.out);
    write_human(options.out);
    for (const fs::path& source : options.sources) write_source(options.out, source);
  } catch (const baker::Error& error) {
    std::cerr << "spherechain_gpu_data: error: " << error.what() << '\n';
    return static_cast<int>(error.code());
  } catch (const fs::filesystem_error& error) {
    std::cerr << "spherechain_gpu_data: error: " << error.what() << '\n';
    return static_cast<int>(baker::ExitCode::kFile);
  }
  return 0;
}
