// SPDX-License-Identifier: MIT
// golden FOLDER [--print]
// Spheres, pairs, leaves' balls, vertices and triangle contacts of a clip of 256 frames, by every job, on every target
// and in one to four threads, hashed, against the folder's hashes.txt: the same on every machine, with every compiler
// and at every optimization level.
//
// Where the runtime's arithmetic changes on purpose, write the hashes anew, look at which lines changed, and commit
// both:
//   build/release/bin/golden tests/golden --print > tests/golden/hashes.txt
// Pairs should change hardly at all then: their count stands beside their hash.
#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>

#include "clip.h"
#include "jobs.h"
#include "spherechain/crowd.h"
#include "spherechain/triangle_contacts.h"

namespace {

using namespace spherechain;
using namespace spherechain::test;

// FNV-1a over words of 32 bits, low byte first.
class Hash {
 public:
  void add(std::uint32_t word) {
    for (unsigned shift = 0; shift < 32; shift += 8) value_ = (value_ ^ (word >> shift & 0xFF)) * 1099511628211U;
  }
  void add(const std::vector<Sphere>& spheres) {
    for (const Sphere& sphere : spheres) {
      std::uint32_t words[4];
      std::memcpy(words, &sphere, sizeof words);
      for (const std::uint32_t word : words) add(word);
    }
    count_ += spheres.size();
  }
  void add(const Pair& pair) { add(pair.a), add(pair.b); }
  // A frame's list and its end.
  template <typename T, typename Add>
  void add_list(const std::vector<T>& list, const Add& add_entry) {
    for (const T& entry : list) add_entry(entry);
    add(0xFFFFFFFFU);
    count_ += list.size();
  }
  std::string line(const std::string& name) const {
    char text[120];
    std::snprintf(text, sizeof text, "%-28s %8zu %016" PRIx64, name.c_str(), count_, value_);
    return text;
  }

 private:
  std::uint64_t value_ = 14695981039346656037U;
  std::size_t count_ = 0;
};

struct Table {
  std::vector<std::string> lines;
  bool agrees = true;  // all ways of getting a line gave the same

  // `how` names the way: a target, a number of threads.
  void add(const std::string& name, const Hash& hash, const std::string& how) {
    const std::string line = hash.line(name);
    const auto same_name = [&](const std::string& other) { return other.compare(0, 29, line, 0, 29) == 0; };
    const auto found = std::find_if(lines.begin(), lines.end(), same_name);
    if (found == lines.end()) {
      lines.push_back(line);
    } else if (*found != line) {
      std::fprintf(stderr, "golden: %s differs: %s, elsewhere %s\n", how.c_str(), line.c_str(), found->c_str());
      agrees = false;
    }
  }
  void expect(bool holds, const char* what, const std::string& how) {
    if (!holds) std::fprintf(stderr, "golden: %s: %s\n", how.c_str(), what);
    agrees = agrees && holds;
  }
};

const char* name_of(RadiusKind radius) { return radius == RadiusKind::kFit ? "fit" : "detect"; }

using Palette = std::vector<std::array<float, 12>>;
using Frames = std::vector<std::vector<Sphere>>;

Frames from_vertices(const Doll& doll, const std::vector<Palette>& clip, RadiusKind radius, const std::string& name,
                     Table& table) {
  Frames frames;
  Hash hash;
  for (const Palette& palette : clip) {
    const std::vector<float> positions = positions_at(doll, palette);
    frames.push_back(refit(doll.asset, positions, radius).spheres);
    hash.add(frames.back());
    std::vector<float> packed;
    for (const std::uint32_t v : doll.asset.pivot_vertices()) {
      packed.insert(packed.end(), {positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]});
    }
    RefitJob job;
    job.asset = &doll.asset;
    job.positions = packed.data();
    job.vertex_count = packed.size() / 3;
    job.vertices = VertexSet::kPivots;
    job.radius = radius;
    std::vector<Sphere> spheres(frames.back().size());
    job.spheres = {spheres.data(), spheres.size()};
    table.expect(job.run() == Status::kOk && same_bits(spheres, frames.back()), "other spheres", "pivots' vertices");
  }
  table.add(name + " " + name_of(radius), hash, "vertices");
  return frames;
}

// `palette` as 16 floats by columns.
std::vector<float> transposed(const Palette& palette) {
  std::vector<float> out;
  for (const auto& m : palette) {
    for (std::size_t column = 0; column < 4; ++column) {
      out.insert(out.end(), {m[column], m[4 + column], m[8 + column], column == 3 ? 1.0F : 0.0F});
    }
  }
  return out;
}

Frames from_bones(const Doll& doll, const std::vector<Palette>& clip, RadiusKind radius, const std::string& name,
                  Target target, Table& table) {
  Frames frames;
  Hash hash;
  for (const Palette& palette : clip) {
    frames.push_back(refit_bones(doll.asset, {palette[0].data(), palette.size()}, {}, radius, target).spheres);
    hash.add(frames.back());
    const std::vector<float> columns = transposed(palette);
    const BoneMatrices other{columns.data(), palette.size(), MatrixLayout::kColumnMajor4x4, 64};
    table.expect(same_bits(refit_bones(doll.asset, other, {}, radius, target).spheres, frames.back()), "other spheres",
                 std::string(to_string(target)) + ", matrices by columns");
  }
  table.add(name + " " + name_of(radius), hash, to_string(target));
  return frames;
}

// The same pairs as bits, as a count and as the first alone.
void check_other_outputs(const Asset& asset, const std::vector<Sphere>& spheres, RadiusKind radius, Target target,
                         const Detected& found, Table& table) {
  std::vector<std::uint64_t> bits(DetectJob::bit_words(asset));
  for (const Pair& pair : found.pairs) {
    const std::size_t bit = std::size_t{pair.b} * (pair.b - 1) / 2 + pair.a;
    bits[bit / 64] |= std::uint64_t{1} << (bit % 64);
  }
  table.expect(bits == found.bits, "other bits", to_string(target));
  Pair first{};
  DetectJob job;
  job.asset = &asset;
  job.spheres = {spheres.data(), spheres.size()};
  job.radius = radius;
  job.target = target;
  table.expect(job.run() == Status::kOk && job.pair_count == found.pairs.size(), "another count", to_string(target));
  job.first_only = true;
  job.pairs = {&first, 1};
  const std::size_t expected = std::min<std::size_t>(1, found.pairs.size());
  table.expect(job.run() == Status::kOk && job.pair_count == expected && (expected == 0 || first == found.pairs[0]),
               "another first pair", to_string(target));
}

void find_pairs(const Asset& asset, const Frames& frames, RadiusKind radius, const std::string& from, Target target,
                Table& table) {
  Hash m1, m2, chains;
  for (const std::vector<Sphere>& spheres : frames) {
    const Detected by_chains = detect(asset, spheres, Method::kM1, radius, target);
    const Detected all = detect(asset, spheres, Method::kM2, radius, target);
    table.expect(by_chains.status == Status::kOk && all.status == Status::kOk, "other pairs by a table",
                 to_string(target));
    m1.add_list(by_chains.pairs, [&](const Pair& pair) { m1.add(pair); });
    m2.add_list(all.pairs, [&](const Pair& pair) { m2.add(pair); });
    chains.add_list(by_chains.chain_pairs,
                    [&](const ChainPair& entry) { chains.add(entry.chain), chains.add(entry.pair); });
    check_other_outputs(asset, spheres, radius, target, all, table);
  }
  const std::string tail = " " + from + " " + name_of(radius);
  table.add("M1" + tail, m1, to_string(target));
  table.add("M1 by chain" + tail, chains, to_string(target));
  table.add("M2" + tail, m2, to_string(target));
}

void on_threads(void*, std::size_t count, void (*task)(void*, std::size_t), void* data) {
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < count; ++i) threads.emplace_back(task, data, i);
  for (std::thread& thread : threads) thread.join();
}

// The whole clip in one call, an instance a frame. Its hash is that of M2 from bones.
void find_in_crowd(const Asset& asset, const std::vector<Palette>& clip, RadiusKind radius, const std::string& name,
                   Target target, std::size_t threads, Table& table) {
  std::vector<float> matrices;
  for (const Palette& palette : clip) {
    for (const auto& m : palette) matrices.insert(matrices.end(), m.begin(), m.end());
  }
  std::vector<std::uint64_t> words(CrowdContext::words_needed(asset, threads), 0x5555555555555555U);
  std::vector<std::uint64_t> bits(clip.size() * DetectJob::bit_words(asset)), expected_bits(bits.size());
  std::vector<std::uint32_t> counts(clip.size());
  std::vector<CrowdPair> pairs(clip.size() * 1000);
  CrowdContext context{{words.data(), words.size()}};
  CrowdJob job;
  job.asset = &asset;
  job.instance_count = clip.size();
  job.bones = {matrices.data(), asset.bone_count()};
  job.instance_stride = asset.bone_count() * 48;
  job.radius = radius;
  job.target = target;
  job.context = &context;
  job.hook.parallel_for = on_threads;
  job.task_count = threads;
  job.counts = {counts.data(), counts.size()};
  job.pairs = {pairs.data(), pairs.size()};
  if (threads % 2 == 0) job.bits = {bits.data(), bits.size()};
  const std::string how = std::string(to_string(target)) + ", " + std::to_string(threads) + " threads";
  table.expect(job.run() == Status::kOk, "the crowd fails", how);
  Hash hash;
  std::size_t at = 0;
  for (std::size_t i = 0; i < clip.size(); ++i) {
    std::vector<Pair> own;
    for (; at < job.pair_count && pairs[at].instance == i; ++at) own.push_back(pairs[at].pair);
    table.expect(own.size() == counts[i], "another count of an instance", how);
    hash.add_list(own, [&](const Pair& pair) { hash.add(pair); });
    for (const Pair& pair : own) {
      const std::size_t bit = std::size_t{pair.b} * (pair.b - 1) / 2 + pair.a;
      expected_bits[i * DetectJob::bit_words(asset) + bit / 64] |= std::uint64_t{1} << (bit % 64);
    }
  }
  table.expect(at == job.pair_count, "pairs of no instance", how);
  table.expect(job.bits.size == 0 || bits == expected_bits, "other bits", how);
  table.add("M2 " + name + " " + name_of(radius), hash, "crowd, " + how);
}

std::vector<TrianglePair> contacts_of(const Doll& doll, const std::vector<float>& positions, Target target) {
  std::vector<std::uint64_t> words(TriangleContactContext::words_needed(doll.asset), 0x5555555555555555U);
  TriangleContactContext context{{words.data(), words.size()}};
  std::vector<TrianglePair> pairs(20000);
  TriangleContactJob job;
  job.asset = &doll.asset;
  job.positions = positions.data();
  job.vertex_count = positions.size() / 3;
  job.target = target;
  job.context = &context;
  job.pairs = {pairs.data(), pairs.size()};
  pairs.resize(job.run() == Status::kOk ? job.pair_count : 0);
  return pairs;
}

// Leaves' balls, the surface's vertices and exact contacts.
void hash_surface(const Doll& doll, const std::vector<Palette>& clip, Table& table) {
  for (const Target target : supported_targets()) {
    Hash leaves, spheres, vertices, contacts;
    for (const Palette& palette : clip) {
      const BoneMatrices bones{palette[0].data(), palette.size()};
      const Covered covered = cover(doll.asset, bones, {}, target);
      leaves.add(covered.leaves);
      spheres.add(covered.spheres);
      const std::vector<float> skinned = skin(doll.asset, bones, {}, target).positions;
      std::vector<Sphere> points;
      for (const std::uint32_t v : doll.asset.surface().source_vertices) {
        points.push_back({skinned[3 * v], skinned[3 * v + 1], skinned[3 * v + 2], 0});
      }
      vertices.add(points);
      const std::vector<TrianglePair> pairs = contacts_of(doll, positions_at(doll, palette), target);
      contacts.add_list(pairs, [&](const TrianglePair& pair) { contacts.add(Pair{pair.a, pair.b}); });
    }
    table.add("cover leaves", leaves, to_string(target));
    table.add("cover spheres", spheres, to_string(target));
    table.add("skinned vertices", vertices, to_string(target));
    table.add("triangle contacts", contacts, to_string(target));
  }
}

// Spheres and pairs under an asset's refit rule: their lines are named after what they come from.
void hash_refits(const Doll& doll, const std::string& vertices, const std::string& bones, Table& table) {
  std::vector<Palette> clip;
  for (std::size_t frame = 0; frame < kFrames; ++frame) clip.push_back(matrices_at(doll.asset, frame));
  for (const RadiusKind radius : {RadiusKind::kFit, RadiusKind::kDetect}) {
    const Frames by_vertices = from_vertices(doll, clip, radius, vertices, table);
    for (const Target target : supported_targets()) {
      find_pairs(doll.asset, by_vertices, radius, vertices, target, table);
      find_pairs(doll.asset, from_bones(doll, clip, radius, bones, target, table), radius, bones, target, table);
      for (std::size_t threads = 1; threads <= 4; ++threads) {
        find_in_crowd(doll.asset, clip, radius, bones, target, threads, table);
      }
    }
  }
}

Table hash_all(const Doll& doll, const Doll& by_moments, const Doll& with_surface) {
  Table table;
  hash_refits(doll, "vertices", "bones", table);
  hash_refits(by_moments, "squares", "moments", table);
  std::vector<Palette> clip;
  for (std::size_t frame = 0; frame < kFrames; ++frame) clip.push_back(matrices_at(with_surface.asset, frame));
  hash_surface(with_surface, clip, table);
  return table;
}

int compare(const Table& table, const std::string& path) {
  std::ifstream file(path);
  std::vector<std::string> wanted;
  for (std::string line; std::getline(file, line);) wanted.push_back(line);
  bool same = wanted.size() == table.lines.size();
  for (std::size_t i = 0; i < std::max(wanted.size(), table.lines.size()); ++i) {
    const std::string found = i < table.lines.size() ? table.lines[i] : "nothing";
    const std::string expected = i < wanted.size() ? wanted[i] : "nothing";
    if (found != expected) {
      std::fprintf(stderr, "golden: found    %s\n        expected %s\n", found.c_str(), expected.c_str());
      same = false;
    }
  }
  std::printf("%zu hashes over %zu frames on", table.lines.size(), kFrames);
  for (const Target target : supported_targets()) std::printf(" %s", to_string(target));
  std::printf(": %s\n", same && table.agrees ? "as they should be" : "not as they should be");
  return same && table.agrees ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const bool prints = argc == 3 && std::strcmp(argv[2], "--print") == 0;
  if (argc != 2 && !prints) {
    std::fputs("usage: golden FOLDER [--print]\n", stderr);
    return 2;
  }
  const Doll doll(argv[1], "doll.sphc"), by_moments(argv[1], "doll_moments.sphc");
  const Doll with_surface(argv[1], "doll_surface.sphc");
  for (const Doll* opened : {&doll, &by_moments, &with_surface}) {
    if (!opened->error.empty()) {
      std::fprintf(stderr, "golden: error: %s\n", opened->error.c_str());
      return 3;
    }
  }
  const Table table = hash_all(doll, by_moments, with_surface);
  if (!prints) {
    return compare(table, std::string(argv[1]) + "/hashes.txt");
  }
  for (const std::string& line : table.lines) std::puts(line.c_str());
  return table.agrees ? 0 : 1;
}
