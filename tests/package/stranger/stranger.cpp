// SPDX-License-Identifier: MIT
// Opens an asset and calls every function of the C++ API: what a shared library forgot to give out does not link.
#include <spherechain/contacts.h>
#include <spherechain/crowd.h>
#include <spherechain/detect.h>
#include <spherechain/refit.h>
#include <spherechain/refit_bones.h>

#include <cstdint>
#include <cstdio>
#include <vector>

using namespace spherechain;

namespace {

std::vector<std::uint64_t> read(const char* path) {
  std::vector<std::uint64_t> bytes;
  if (std::FILE* file = std::fopen(path, "rb")) {
    std::uint64_t word = 0;
    while (std::fread(&word, 1, sizeof word, file) > 0) {
      bytes.push_back(word);
      word = 0;
    }
    std::fclose(file);
  }
  return bytes;
}

// The accessors and functions that the road from bones to pairs has no use for.
std::size_t call_the_rest(const Asset& asset, const std::vector<Sphere>& spheres, const std::vector<Pair>& pairs) {
  std::vector<std::uint64_t> ignored(Filter::ignored_words(asset)), disabled(Filter::disabled_words(asset));
  std::vector<float> padding(spheres.size());
  Filter filter{{ignored.data(), ignored.size()}, {disabled.data(), disabled.size()}, {padding.data(), padding.size()}};
  std::size_t failed = 0;
  for (const Status status :
       {reset_filter(asset, filter), check_filter(asset, filter), ignore_pair(asset, filter, 0, 1),
        ignore_regions(asset, filter, 0, 1), ignore_hops(asset, filter, 1), disable_sphere(asset, filter, 0),
        pad_sphere(asset, filter, 0, 0.5F)}) {
    failed += status != Status::kOk;
  }
  ContactJob contacts;
  contacts.asset = &asset;
  contacts.spheres = {spheres.data(), spheres.size()};
  contacts.pairs = {pairs.data(), pairs.size()};
  failed += contacts.run() != Status::kOk;

  std::vector<std::uint64_t> words(CrowdContext::words_needed(asset, 1));
  std::vector<std::uint32_t> counts(1);
  CrowdContext context{{words.data(), words.size()}};
  CrowdJob crowd;
  crowd.asset = &asset;
  crowd.spheres = spheres.data();
  crowd.instance_count = 1;
  crowd.context = &context;
  crowd.counts = {counts.data(), counts.size()};
  failed += crowd.run() != Status::kOk || counts[0] != pairs.size();

  const float position[3] = {0.0F, 0.0F, 0.0F};
  RefitJob refit;
  refit.asset = &asset;
  refit.positions = position;
  refit.vertex_count = 1;
  failed += refit.run() == Status::kOk;
  failed += check_source(asset, position, 1) == Status::kOk;
  failed += check_source_part(asset, 0, position, 1) == Status::kOk;
  failed += hash_positions(position, 1) == 0;

  Target target{};
  failed += find_target("best", target) != Status::kOk || lanes_of(best_target()) == 0;
  failed += *to_string(target) == '\0' || *to_string(Status::kOk) == '\0' || abi_version() != SC_ABI_VERSION;
  failed += asset.info().format_version != 1 || asset.region(0).name == nullptr || asset.region_count() == 0;
  failed += asset.chain(0).name == nullptr || asset.chain_count() == 0;
  failed += asset.joint_count() > 0 && asset.joint(0).name == nullptr;
  failed += asset.bone_count() > 0 && asset.bone(0).name == nullptr;
  failed += asset.morph_count() > 0 && asset.morph_name(0) == nullptr;
  return failed + (asset.refit_rule() == RefitRule::kPaper) + (DetectContext::words_needed(asset) == 0) +
         (DetectJob::bit_words(asset) == 0);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::uint64_t> bytes = read(argc > 1 ? argv[1] : "");
  Asset asset;
  char message[160];
  if (asset.open(bytes.data(), bytes.size() * sizeof bytes[0], message, sizeof message) != Status::kOk) {
    std::fprintf(stderr, "stranger_cpp: %s\n", message);
    return 3;
  }
  const float identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  std::vector<float> matrices;
  for (std::size_t i = 0; i < asset.bone_count(); ++i) {
    matrices.insert(matrices.end(), identity, identity + 12);
  }
  std::vector<Sphere> spheres(asset.spheres().size);
  RefitBonesJob refit;
  refit.asset = &asset;
  refit.bones = {matrices.data(), asset.bone_count()};
  refit.spheres = {spheres.data(), spheres.size()};
  std::vector<Pair> pairs(spheres.size() * spheres.size());
  DetectJob detect;
  detect.asset = &asset;
  detect.spheres = {spheres.data(), spheres.size()};
  detect.pairs = {pairs.data(), pairs.size()};
  if (refit.run() != Status::kOk || detect.run() != Status::kOk) {
    return 1;
  }
  pairs.resize(detect.pair_count);
  std::printf("%zu spheres, %zu pairs\n", spheres.size(), pairs.size());
  return static_cast<int>(call_the_rest(asset, spheres, pairs));
}
