// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>

#include "both_apis.h"
#include "spherechain/confirm.h"
#include "spherechain/triangle_contacts.h"

namespace spherechain::test {
namespace {

template <typename Job>
void give_skin(const BothApis& both, const std::vector<float>& positions, std::vector<std::uint64_t>& scratch,
               Job& job) {
  job.asset = both.asset;
  job.positions = positions.data();
  job.vertex_count = positions.size() / 4;
  job.stride = 16;
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
}

}  // namespace

TEST_CASE("C: triangle contacts, pairs found and confirmed by them, are those of the C++ jobs") {
  const BothApis both;
  const Asset& asset = both.opened.asset;
  // All regions at the same place: much intersects.
  std::vector<float> positions(4 * asset.info().source_vertex_count);
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = static_cast<float>(i * i % 97) / 97;
  std::vector<std::uint64_t> words(TriangleContactContext::words_needed(asset)),
      c_words(sc_triangle_contact_scratch_words(both.asset));
  REQUIRE(words.size() == c_words.size());
  TriangleContactContext context{{words.data(), words.size()}};
  TriangleContactJob job;
  job.asset = &asset;
  job.positions = positions.data();
  job.vertex_count = positions.size() / 4;
  job.stride = 16;
  job.context = &context;
  job.scope = ContactScope::kAll;
  REQUIRE(job.run() == Status::kOk);
  REQUIRE(job.pair_count > 10);
  REQUIRE(job.sphere_contact_count > 1);
  std::vector<TriangleContact> contacts(job.pair_count);
  std::vector<SphereContact> sphere_contacts(job.sphere_contact_count);
  job.contacts = {contacts.data(), contacts.size()};
  job.sphere_contacts = {sphere_contacts.data(), sphere_contacts.size()};
  REQUIRE(job.run() == Status::kOk);

  sc_triangle_contact_job c_job = SC_TRIANGLE_CONTACT_JOB_INIT;
  give_skin(both, positions, c_words, c_job);
  c_job.scope = SC_CONTACTS_ALL;
  std::vector<sc_triangle_pair> c_pairs(job.pair_count);
  std::vector<sc_triangle_contact> c_contacts(job.pair_count);
  std::vector<sc_sphere_contact> c_sphere_contacts(job.sphere_contact_count);
  c_job.pairs = c_pairs.data();
  c_job.pair_capacity = c_pairs.size();
  c_job.contacts = c_contacts.data();
  c_job.contact_capacity = c_contacts.size();
  c_job.sphere_contacts = c_sphere_contacts.data();
  c_job.sphere_contact_capacity = c_sphere_contacts.size();
  REQUIRE(sc_triangle_contacts(&c_job) == SC_OK);
  CHECK(c_job.pair_count == job.pair_count);
  CHECK(c_job.sphere_contact_count == job.sphere_contact_count);
  CHECK(same_bytes(c_contacts, contacts));
  CHECK(same_bytes(c_sphere_contacts, sphere_contacts));
  for (std::size_t i = 0; i < c_pairs.size(); ++i) CHECK(c_pairs[i].b == contacts[i].triangles.b);
  c_job.pair_capacity = 1;
  CHECK(sc_triangle_contacts(&c_job) == SC_OVERFLOW);
  c_job.scope = 256;
  CHECK(sc_triangle_contacts(&c_job) == SC_BAD_ARGUMENT);
  c_job.scratch = nullptr;
  CHECK(sc_triangle_contacts(&c_job) == SC_NULL_ARGUMENT);
  CHECK(sc_triangle_contact_scratch_words(nullptr) == 0);

  std::vector<std::uint64_t> none(sc_filter_ignored_words(both.asset));
  const sc_filter filter{none.data(), none.size(), nullptr, 0, nullptr, 0};
  std::vector<sc_pair> of_skin(job.sphere_contact_count);
  sc_detect_skin_job detect = SC_DETECT_SKIN_JOB_INIT;
  give_skin(both, positions, c_words, detect);
  detect.filter = &filter;
  detect.pairs = of_skin.data();
  detect.pair_capacity = of_skin.size();
  REQUIRE(sc_detect_skin(&detect) == SC_OK);
  of_skin.resize(detect.pair_count);

  std::vector<sc_pair> candidates, expected;
  for (std::uint32_t b = 1; b < asset.spheres().size; ++b) {
    for (std::uint32_t a = 0; a < b; ++a) {
      candidates.push_back({a, b});
      const auto is_it = [&](const SphereContact& contact) { return contact.spheres == Pair{a, b}; };
      if (std::any_of(sphere_contacts.begin(), sphere_contacts.end(), is_it)) expected.push_back({a, b});
    }
  }
  std::vector<sc_pair> confirmed(expected.size());
  sc_confirm_job confirm = SC_CONFIRM_JOB_INIT;
  give_skin(both, positions, c_words, confirm);
  confirm.candidates = candidates.data();
  confirm.candidate_count = candidates.size();
  confirm.pairs = confirmed.data();
  confirm.pair_capacity = confirmed.size();
  REQUIRE(sc_confirm(&confirm) == SC_OK);
  CHECK(confirm.pair_count == expected.size());
  CHECK(same_bytes(confirmed, expected));
  const auto is_less = [](const sc_pair& l, const sc_pair& r) { return l.a != r.a ? l.a < r.a : l.b < r.b; };
  std::sort(expected.begin(), expected.end(), is_less);
  CHECK(same_bytes(of_skin, expected));
}

}  // namespace spherechain::test
