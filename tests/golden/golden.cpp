// SPDX-License-Identifier: MIT
// golden FOLDER [--print RELEASE]
// Opens the assets of each release, in a folder of FOLDER. Hashes the spheres, pairs, skin contacts, penetrations and
// responses of a clip of 300 frames, on every target and in one to four threads, and compares them with the release's
// hashes.txt. They are the same on every machine, with every compiler and at every optimization level.
//
// Where the runtime's arithmetic changes on purpose, write the hashes of each release anew, look at which lines
// changed, and commit both:
//   build/release/bin/golden tests/golden --print 0.1.0 > tests/golden/0.1.0/hashes.txt
// The counts beside the hashes of pairs and contacts should then hardly change.
#include <algorithm>
#include <cstdio>
#include <cstring>

#include "clip.h"
#include "crowds.h"
#include "hashes.h"
#include "jobs.h"
#include "runtime/src/base/pair_bits.h"
#include "spherechain/response.h"

namespace {

using namespace spherechain;
using namespace spherechain::test;

using Palette = std::vector<std::array<float, 12>>;
using Frames = std::vector<std::vector<Sphere>>;

const char* name_of(Radius radius) { return radius == SC_RADIUS_FIT ? "fit" : "detect"; }

Pose bones_of(const Palette& palette) {
  Pose pose;
  pose.bones = palette[0].data();
  pose.bone_count = palette.size();
  pose.bone_layout = SC_ROWS_3X4;
  return pose;
}

Pose vertices_of(const std::vector<float>& vertices) {
  Pose pose;
  pose.vertices = vertices.data();
  pose.vertex_count = vertices.size() / 3;
  return pose;
}

Frames from_vertices(const Doll& doll, const std::vector<Palette>& clip, Radius radius, const std::string& name,
                     HashTable& table) {
  Frames frames;
  Hash hash;
  for (const Palette& palette : clip) {
    frames.push_back(refit(doll.asset, positions_at(doll, palette), radius).spheres);
    hash.add_array(frames.back());
  }
  table.add("spheres " + name + " " + name_of(radius), hash, "vertices");
  return frames;
}

// `palette` as SC_COLUMNS_4X4.
std::vector<float> by_columns(const Palette& palette) {
  std::vector<float> out;
  for (const auto& m : palette) {
    for (std::size_t column = 0; column < 4; ++column) {
      out.insert(out.end(), {m[column], m[4 + column], m[8 + column], column == 3 ? 1.0F : 0.0F});
    }
  }
  return out;
}

Frames from_bones(const Doll& doll, const std::vector<Palette>& clip, Radius radius, Target target, HashTable& table) {
  Frames frames;
  Hash hash;
  for (const Palette& palette : clip) {
    frames.push_back(refit(doll.asset, bones_of(palette), radius, target).spheres);
    hash.add_array(frames.back());
    const std::vector<float> columns = by_columns(palette);
    Pose other = bones_of(palette);
    other.bones = columns.data();
    other.bone_layout = SC_COLUMNS_4X4;
    table.expect(same_bits(refit(doll.asset, other, radius, target).spheres, frames.back()), "other spheres",
                 std::string(sc_target_name(target)) + ", matrices by columns");
  }
  table.add(std::string("spheres bones ") + name_of(radius), hash, sc_target_name(target));
  return frames;
}

// The pairs as a detect job's bits.
std::vector<std::uint64_t> bits_of(const Asset& asset, const std::vector<Pair>& pairs) {
  std::vector<std::uint64_t> bits(sc_pair_words(&asset));
  for (const Pair& pair : pairs) set_bit({bits.data(), bits.size()}, ignored_bit(pair.a, pair.b));
  return bits;
}

void find_pairs(const Asset& asset, const Frames& frames, Radius radius, const std::string& from, Target target,
                HashTable& table) {
  Hash hash;
  for (const std::vector<Sphere>& spheres : frames) {
    const Detected found = detect(asset, spheres, radius, target);
    table.expect(found.status == SC_OK, "other pairs by a table", sc_target_name(target));
    table.expect(bits_of(asset, found.pairs) == found.bits, "other bits", sc_target_name(target));
    hash.add_list(found.pairs);
  }
  table.add("all_pairs " + from + " " + name_of(radius), hash, sc_target_name(target));
}

// The whole clip in one call, an instance a frame. Its hash is that of the pairs from bones.
void find_in_crowd(const Asset& asset, const std::vector<Palette>& clip, Radius radius, Target target,
                   std::size_t threads, HashTable& table) {
  const std::size_t words = sc_pair_words(&asset);
  std::vector<float> matrices;
  for (const Palette& palette : clip) {
    for (const auto& m : palette) matrices.insert(matrices.end(), m.begin(), m.end());
  }
  CrowdBuffers crowd(asset, clip.size(), threads);
  std::vector<std::uint64_t> bits(clip.size() * words);
  std::vector<CrowdPair> pairs(clip.size() * 1000);
  crowd.job.pose = bones_of(clip[0]);
  crowd.job.pose.bones = matrices.data();
  crowd.job.radius = radius;
  crowd.job.target = target;
  crowd.job.parallel_for = on_threads;
  crowd.job.user = &threads;
  crowd.job.pairs = pairs.data();
  crowd.job.pair_capacity = pairs.size();
  if (threads % 2 == 0) {
    crowd.job.bits = bits.data();
    crowd.job.bit_words = bits.size();
  }
  const std::string how = std::string(sc_target_name(target)) + ", " + std::to_string(threads) + " threads";
  table.expect(crowd.job.run() == SC_OK, "the crowd fails", how);
  Hash hash;
  std::size_t at = 0;
  for (std::size_t i = 0; i < clip.size(); ++i) {
    std::vector<Pair> own;
    for (; at < crowd.job.pair_count && pairs[at].instance == i; ++at) own.push_back(pairs[at].pair);
    table.expect(own.size() == crowd.counts[i], "another count of an instance", how);
    hash.add_list(own);
    const std::vector<std::uint64_t> expected = bits_of(asset, own);
    table.expect(crowd.job.bits == nullptr || std::memcmp(&bits[i * words], expected.data(), 8 * words) == 0,
                 "other bits", how);
  }
  table.expect(at == crowd.job.pair_count, "pairs of no instance", how);
  table.add(std::string("all_pairs bones ") + name_of(radius), hash, "crowd, " + how);
}

// Triangles, the segments in which they cross, and body parts.
struct ContactHashes {
  Hash triangles, segments, parts, penetrations;
  std::vector<Penetration> last;
  int frames = 0;

  void add(const SkinContacts& found, const SkinContactJob& by, Body& body) {
    std::vector<Pair> pairs;
    std::vector<Vec3> ends;
    for (const TriangleContact& contact : found.triangles) {
      pairs.push_back({contact.triangle_a, contact.triangle_b});
      ends.insert(ends.end(), {contact.from, contact.to});
    }
    triangles.add_list(pairs);
    segments.add_list(ends);
    parts.add_list(found.parts);
    if (frames++ % 4 > 0) {
      return;  // the measure takes a minute under sanitizers
    }
    Query query;
    query.full = 1;
    query.classes = ~0U;
    query.previous = last.data();
    query.previous_count = last.size();
    query.target = by.target;
    body.set_pose(by.pose);
    const Penetrations measured = body.penetrations(query);
    last.assign(measured.items, measured.items + measured.count);
    std::sort(last.begin(), last.end(), [](const Penetration& l, const Penetration& r) {
      return std::minmax(l.part, l.other) < std::minmax(r.part, r.other);
    });
    penetrations.add_list(last);
  }
  void add_to(HashTable& table, const std::string& from, Target target) const {
    table.add("triangle contacts " + from, triangles, sc_target_name(target));
    table.add("crossing segments " + from, segments, sc_target_name(target));
    table.add("part contacts " + from, parts, sc_target_name(target));
    table.add("penetrations " + from, penetrations, sc_target_name(target));
  }
};

void hash_skin(const Doll& doll, const std::vector<Palette>& clip, HashTable& table) {
  const PreparedSkin prepared(doll.asset);
  const Model model(doll.bytes.data(), 8 * doll.bytes.size(), nullptr, 0, SC_ROWS_3X4);
  Body body(model);
  for (const Target target : supported_targets()) {
    Hash positions;
    ContactHashes by_vertices, by_bones;
    for (const Palette& palette : clip) {
      const std::vector<float> skinned = skin(doll.asset, bones_of(palette), target);
      std::vector<Sphere> points;
      for (const std::uint32_t v : prepared.surface.source_vertices) {
        points.push_back({skinned[3 * v], skinned[3 * v + 1], skinned[3 * v + 2], 0});
      }
      positions.add_array(points);
      const std::vector<float> vertices = positions_at(doll, palette);
      SkinContactJob job;
      job.asset = &doll.asset;
      job.target = target;
      job.pose = vertices_of(vertices);
      by_vertices.add(find_contacts(job), job, body);
      job.pose = bones_of(palette);
      by_bones.add(find_contacts(job), job, body);
    }
    table.add("skinned vertices", positions, sc_target_name(target));
    by_vertices.add_to(table, "vertices", target);
    by_bones.add_to(table, "bones", target);
  }
}

void hash_response(const Doll& doll, HashTable& table) {
  const Model model(doll.bytes.data(), 8 * doll.bytes.size(), nullptr, 0, SC_ROWS_3X4);
  const std::vector<std::uint32_t> parents = parents_of(doll.asset);
  ResponseDef def;
  def.parents = parents.data();
  def.joint_count = parents.size();
  Body body(model);
  Response response(body, def);
  for (const Target target : supported_targets()) {
    Hash turns;
    ResponseState state;
    for (std::size_t f = 0; f < kFrames; ++f) {
      std::vector<Transform> joints = joints_at(doll.asset, f);
      ResponseFrame frame;
      frame.joints = joints.data();
      frame.seconds = 1.0F / 32;
      frame.target = target;
      table.expect(response.respond(state, frame) == SC_OK, "the response fails", sc_target_name(target));
      std::vector<Sphere> rotations;
      for (const Transform& joint : joints) {
        const float* const r = joint.rotation;
        rotations.push_back({r[0], r[1], r[2], r[3]});
      }
      turns.add_array(rotations);
    }
    table.add("response", turns, sc_target_name(target));
  }
}

std::vector<Palette> clip_of(const Doll& doll) {
  std::vector<Palette> clip;
  for (std::size_t frame = 0; frame < kFrames; ++frame) clip.push_back(matrices_at(doll.asset, frame));
  return clip;
}

HashTable hash_all(const Doll& doll, const Doll& paper) {
  HashTable table;
  const std::vector<Palette> clip = clip_of(doll), paper_clip = clip_of(paper);
  for (const Radius radius : {SC_RADIUS_FIT, SC_RADIUS_DETECT}) {
    const Frames by_vertices = from_vertices(doll, clip, radius, "vertices", table);
    const Frames by_paper = from_vertices(paper, paper_clip, radius, "paper", table);
    for (const Target target : supported_targets()) {
      find_pairs(doll.asset, by_vertices, radius, "vertices", target, table);
      find_pairs(paper.asset, by_paper, radius, "paper", target, table);
      find_pairs(doll.asset, from_bones(doll, clip, radius, target, table), radius, "bones", target, table);
      for (std::size_t threads = 1; threads <= 4; ++threads) {
        find_in_crowd(doll.asset, clip, radius, target, threads, table);
      }
    }
  }
  hash_skin(doll, clip, table);
  hash_response(doll, table);
  return table;
}

// The least bytes that look like an asset of that format: a root table whose only field is the version.
std::vector<std::uint32_t> header_of_format(std::uint32_t version) {
  std::vector<std::uint32_t> words(64);
  words[0] = 16;           // the root table
  words[1] = 0x43485053;   // "SPHC"
  words[2] = 6 | 8 << 16;  // the table's layout: its own size, the table's,
  words[3] = 4;            // and where the first field is
  words[4] = 8;            // the layout is that far before the table
  words[5] = version;
  return words;
}

void check_versions(HashTable& table) {
  for (const std::uint32_t version : {1U, kFormatVersion + 1}) {
    const std::vector<std::uint32_t> old = header_of_format(version);
    const std::string how = "format " + std::to_string(version);
    Asset asset;
    char message[160] = "";
    const Status status = sc_asset_open(&asset, SC_ABI_VERSION, old.data(), 4 * old.size(), message, sizeof message);
    table.expect(status == SC_OTHER_VERSION && sc_part_words(&asset) == 0, "not refused as another version", how);
    table.expect(std::strstr(message, (std::to_string(version) + ", but this runtime reads").c_str()) != nullptr &&
                     std::strstr(message, version < kFormatVersion ? "bake it again" : "update spherechain") != nullptr,
                 "the message does not say what to do", how);
  }
}

constexpr const char* kReleases[] = {"0.1.0"};  // whose assets are opened for ever

// The exit code: 0, 1 for other hashes, or 3 for assets that do not open.
int run(const std::string& folder, bool prints) {
  const Doll doll(folder, "doll.sphc"), paper(folder, "doll_paper.sphc");
  for (const Doll* opened : {&doll, &paper}) {
    if (!opened->error.empty()) {
      std::fprintf(stderr, "golden: error: %s\n", opened->error.c_str());
      return 3;
    }
  }
  HashTable table = hash_all(doll, paper);
  check_versions(table);
  if (prints) {
    for (const std::string& line : table.lines()) std::puts(line.c_str());
    return table.agrees() ? 0 : 1;
  }
  const bool is_right = table.is_that_of(folder + "/hashes.txt") && table.agrees();
  std::printf("%s: %zu hashes over %zu frames on", folder.c_str(), table.lines().size(), kFrames);
  for (const Target target : supported_targets()) std::printf(" %s", sc_target_name(target));
  std::printf(": %s\n", is_right ? "as they should be" : "not as they should be");
  return is_right ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const bool prints = argc == 4 && std::strcmp(argv[2], "--print") == 0;
  if (argc != 2 && !prints) {
    std::fputs("usage: golden FOLDER [--print RELEASE]\n", stderr);
    return 2;
  }
  const std::string folder = std::string(argv[1]) + "/";
  if (prints) {
    return run(folder + argv[3], true);
  }
  int result = 0;
  for (const char* release : kReleases) result = std::max(result, run(folder + release, false));
  return result;
}
