// SPDX-License-Identifier: MIT
// An asset of a later release, which has more fields than this schema: later_format.cmake adds them to a copy of it.
#include <doctest/doctest.h>

#include <vector>

#include "../../golden/clip.h"
#include "jobs.h"
#include "later_generated.h"
#include "spherechain/spherechain.h"

namespace spherechain::test {

TEST_CASE("an asset that only has more optional fields opens, and gives the same answers") {
  const Doll doll(DOLL_FOLDER, "doll.sphc");
  REQUIRE_MESSAGE(doll.error.empty(), doll.error);
  later::AssetT asset;
  later::GetAsset(doll.bytes.data())->UnPackTo(&asset);
  asset.sphere_weights.assign(asset.spheres.size(), 0.5F);
  asset.parts[1]->colour = 0xFF00FF;
  asset.notes.push_back(std::make_unique<later::NoteT>());
  asset.notes[0]->text = "of a later release";
  flatbuffers::FlatBufferBuilder builder;
  later::FinishAssetBuffer(builder, later::Asset::Pack(builder, &asset));
  const std::vector<std::uint64_t> words = [&] {
    std::vector<std::uint64_t> out((builder.GetSize() + 7) / 8);
    std::copy_n(builder.GetBufferPointer(), builder.GetSize(), reinterpret_cast<std::uint8_t*>(out.data()));
    return out;
  }();
  CHECK(builder.GetSize() > 8 * doll.bytes.size());
  const Model now(doll.bytes.data(), 8 * doll.bytes.size(), nullptr, 0, SC_ROWS_3X4),
      later(words.data(), builder.GetSize(), nullptr, 0, SC_ROWS_3X4);
  REQUIRE_MESSAGE(later, std::string(later.message()));
  Body one(now), other(later);
  Query all;
  all.full = 1;
  all.classes = ~0U;
  std::size_t count = 0;
  for (const std::size_t frame : {40U, 100U, 160U, 220U}) {
    const std::vector<std::array<float, 12>> palette = matrices_at(doll.asset, frame);
    Pose pose;
    pose.bones = palette[0].data();
    pose.bone_count = palette.size();
    pose.bone_layout = SC_ROWS_3X4;
    REQUIRE(one.set_pose(pose) == SC_OK);
    REQUIRE(other.set_pose(pose) == SC_OK);
    const Penetrations expected = one.penetrations(all), found = other.penetrations(all);
    CHECK(same_bits(std::vector<Penetration>(found.begin(), found.end()),
                    std::vector<Penetration>(expected.begin(), expected.end())));
    count += expected.count;
  }
  CHECK(count > 0);
}

}  // namespace spherechain::test
