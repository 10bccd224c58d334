// SPDX-License-Identifier: MIT
// What is launched where: what the emulated runs cannot show.
#include <doctest/doctest.h>

#include "crowd_cases.h"
#include "crowd_launch.h"

namespace spherechain::test {
namespace {

using cuda::Kernel;

struct Group {
  Group(const std::vector<std::uint64_t>& table, std::size_t instances) {
    group.table = table.data();
    group.device_table = reinterpret_cast<const std::uint64_t*>(memory);
    group.spheres = reinterpret_cast<const Sphere*>(memory);
    group.instance_count = instances;
  }
  alignas(16) unsigned char memory[16] = {};  // named, not read
  cuda::CrowdGroup group;
};

}  // namespace

TEST_CASE("groups go to shared memory where it is large enough, and else to as many blocks of scratch as fit") {
  const OpenedAsset large(random_asset(300, 1).parts), small(random_asset(20, 2).parts);
  const std::vector<std::uint64_t> a = table_of(large.asset, SC_RADIUS_FIT), b = table_of(small.asset, SC_RADIUS_FIT);
  Group groups[] = {Group(b, 33), Group(a, 100), Group(b, 0), Group(a, 31), Group(b, 64)};
  const std::size_t block = [&] {  // without bits
    cuda::GroupView view;
    REQUIRE(cuda::view_group(groups[1].group, view) == SC_OK);
    return view.layout.size;
  }();
  std::vector<cuda::CrowdGroup> all;
  for (Group& one : groups) {
    one.group.scratch = one.memory;
    one.group.scratch_bytes = 3 * block + 16;
    all.push_back(one.group);
  }
  cuda::Launch views;
  cuda::LaunchPlan plan;
  REQUIRE(cuda::view_groups(all.data(), all.size(), views) == SC_OK);
  CHECK(views.count == 4);
  REQUIRE(cuda::plan_launches(views, block - 1, plan) == SC_OK);
  REQUIRE(plan[Kernel::kSpheres].count == 2);
  CHECK(plan[Kernel::kSpheres].views[1].first_block == 5);
  CHECK(!plan[Kernel::kSpheres].views[0].in_scratch);
  CHECK(plan[Kernel::kSpheres].blocks == 13);  // of eight instances
  CHECK(plan[Kernel::kSpheres].shared_bytes < block / 5);
  REQUIRE(plan[Kernel::kScratch].count == 2);
  CHECK(plan[Kernel::kScratch].views[0].scratch_blocks == 3);  // of 13
  CHECK(plan[Kernel::kScratch].views[1].scratch_blocks == 3);
  CHECK(plan[Kernel::kScratch].views[1].first_block == 3);
  CHECK(plan[Kernel::kScratch].blocks == 6);
  CHECK(plan[Kernel::kScratch].views[0].in_scratch);
  views.views[1].instance_count = 1;  // as of an asset of more spheres than a block's places reach, with scratch for it
  views.views[1].sphere_count = 60000;
  views.views[1].bit_words = 60000U * 59999U / 128 + 1;
  views.views[1].bits = reinterpret_cast<std::uint64_t*>(groups[1].memory);
  views.views[1].pose.bones = reinterpret_cast<const float*>(groups[1].memory);
  const cuda::BlockLayout largest = views.views[1].layout = cuda::layout_of(views.views[1], {true, true, false});
  views.views[1].scratch_bytes = ~std::size_t{0};
  CHECK(largest.size > std::size_t{4} << 30);
  CHECK(cuda::plan_launches(views, block, plan) == SC_DEVICE_TOO_SMALL);
  REQUIRE(cuda::view_groups(all.data(), all.size(), views) == SC_OK);
  REQUIRE(cuda::plan_launches(views, block, plan) == SC_OK);
  CHECK(plan[Kernel::kSpheres].count == 4);
  CHECK(plan[Kernel::kScratch].count == 0);
  CHECK(plan[Kernel::kSpheres].shared_bytes == block);
}

TEST_CASE("too many groups, none at all and a null list are distinguished") {
  const OpenedAsset small(random_asset(9, 2).parts);
  const std::vector<std::uint64_t> table = table_of(small.asset, SC_RADIUS_FIT);
  const Group group(table, 1);
  std::vector<cuda::CrowdGroup> all(cuda::kCrowdGroupsMax + 1, group.group);
  cuda::Launch views;
  CHECK(cuda::view_groups(all.data(), all.size(), views) == SC_BAD_VALUE);
  CHECK(cuda::view_groups(all.data(), all.size() - 1, views) == SC_OK);
  CHECK(cuda::view_groups(nullptr, 1, views) == SC_NULL);
  CHECK(cuda::view_groups(nullptr, 0, views) == SC_OK);
  CHECK(views.count == 0);
}

}  // namespace spherechain::test
