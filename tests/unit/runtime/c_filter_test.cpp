// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "both_apis.h"
#include "spherechain/contacts.h"

namespace spherechain::test {

TEST_CASE("C: filters are edited as in C++, and jobs heed them") {
  const BothApis both;
  const Asset& view = both.opened.asset;
  std::vector<std::uint64_t> ignored(sc_filter_ignored_words(both.asset)),
      disabled(sc_filter_disabled_words(both.asset));
  std::vector<float> padding(70);
  std::vector<std::uint64_t> expected_ignored(ignored.size()), expected_disabled(disabled.size());
  std::vector<float> expected_padding(70);
  sc_filter filter = {ignored.data(), ignored.size(), disabled.data(), disabled.size(), padding.data(), padding.size()};
  Filter expected{{expected_ignored.data(), ignored.size()},
                  {expected_disabled.data(), disabled.size()},
                  {expected_padding.data(), padding.size()}};
  const auto is_same = [&] {
    return ignored == expected_ignored && disabled == expected_disabled && padding == expected_padding;
  };
  REQUIRE(sc_check_filter(both.asset, &filter) == SC_OK);
  REQUIRE(sc_reset_filter(both.asset, &filter) == SC_OK);
  REQUIRE(reset_filter(view, expected) == Status::kOk);
  CHECK(is_same());
  const std::vector<std::uint64_t> before = ignored;
  CHECK(sc_ignore_hops(both.asset, &filter, 2, 1) == SC_OK);
  CHECK(ignore_hops(view, expected, 2) == Status::kOk);
  CHECK(is_same());
  CHECK(sc_ignore_regions(both.asset, &filter, 0, 1, 0) == SC_OK);
  CHECK(ignore_regions(view, expected, 0, 1, false) == Status::kOk);
  CHECK(is_same());
  CHECK(sc_ignore_pair(both.asset, &filter, 3, 9, 1) == SC_OK);
  CHECK(ignore_pair(view, expected, 3, 9) == Status::kOk);
  CHECK(sc_disable_sphere(both.asset, &filter, 4, 1) == SC_OK);
  CHECK(disable_sphere(view, expected, 4) == Status::kOk);
  CHECK(sc_pad_sphere(both.asset, &filter, 5, 0.25F) == SC_OK);
  CHECK(pad_sphere(view, expected, 5, 0.25F) == Status::kOk);
  CHECK(is_same());
  CHECK(ignored != before);
  CHECK(sc_pad_sphere(both.asset, &filter, 70, 0.25F) == SC_BAD_ARGUMENT);
  CHECK(sc_reset_filter(both.asset, nullptr) == SC_NULL_ARGUMENT);

  const std::vector<Pair> pairs =
      detect(view, both.spheres, Method::kM2, RadiusKind::kDetect, Target::kBest, &expected).pairs;
  REQUIRE(pairs != detect(view, both.spheres, Method::kM2, RadiusKind::kDetect).pairs);
  std::vector<sc_pair> c_pairs(pairs.size());
  sc_detect_job job = SC_DETECT_JOB_INIT;
  both.give_spheres(job);
  job.filter = &filter;
  job.pairs = c_pairs.data();
  job.pair_capacity = c_pairs.size();
  CHECK(sc_detect(&job) == SC_OK);
  CHECK(same_bytes(c_pairs, pairs));
  filter.ignored_words -= 1;
  CHECK(sc_detect(&job) == SC_BAD_FILTER);

  filter.ignored_words += 1;
  std::vector<Contact> contacts(pairs.size());
  ContactJob expected_job;
  expected_job.asset = &view;
  expected_job.spheres = {both.spheres.data(), both.spheres.size()};
  expected_job.pairs = {pairs.data(), pairs.size()};
  expected_job.filter = &expected;
  expected_job.contacts = {contacts.data(), contacts.size()};
  REQUIRE(expected_job.run() == Status::kOk);
  std::vector<sc_contact> c_contacts(pairs.size());
  sc_contact_job contact = SC_CONTACT_JOB_INIT;
  both.give_spheres(contact);
  contact.pairs = c_pairs.data();
  contact.pair_count = c_pairs.size();
  contact.filter = &filter;
  contact.contacts = c_contacts.data();
  contact.contact_capacity = c_contacts.size();
  CHECK(sc_contacts(&contact) == SC_OK);
  CHECK(same_bytes(c_contacts, contacts));
  CHECK(contact.contact_count == pairs.size());
  CHECK(contact.deepest == expected_job.deepest);
}

}  // namespace spherechain::test
