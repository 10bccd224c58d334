// SPDX-License-Identifier: MIT
// Contacts of any pairs.
#include <algorithm>

#include "fuzz_case.h"
#include "spherechain/contacts.h"

namespace spherechain::test {
namespace {

void spoil_contacts(Case& c, ContactJob& job, sc_contact_job& c_job, Pair* pairs, Filter& filter, std::uint32_t way,
                    Spoiled& spoiled) {
  switch (way) {
    case 0:
    case 1:
      return spoil_asset(c, job, c_job, way, spoiled);
    case 2:
      job.spheres.data = nullptr;
      return spoiled.with(Status::kNullArgument);
    case 3:
      job.spheres.size = c.random.up_to(c.n - 1);
      return spoiled.with(Status::kTooFewSpheres);
    case 4:
      job.pairs = {nullptr, 1};
      return spoiled.with(Status::kNullArgument);
    case 5:
      job.contacts = {nullptr, 1};
      return spoiled.with(Status::kNullArgument);
    case 6:
      if (job.pairs.size > 0 && job.pairs.data == pairs) {
        const auto n = static_cast<std::uint32_t>(c.n);
        const Pair bad[] = {{0, n}, {n, n + 1}, {1, 1}, {1, 0}, {0xFFFFFFFFU, 0xFFFFFFFFU}, {0, 0xFFFFFFFFU}};
        pairs[c.random.up_to(job.pairs.size - 1)] = c.random.pick(bad);
        spoiled.with(Status::kBadArgument);
      }
      return;
    case 7:
      job.filter = &filter;
      if (filter.ignored.data == nullptr) filter = draw_filter(c);
      return spoil_filter(c, filter, spoiled);
    case 8:
      put_askew(c, job.spheres.data);
      return spoiled.with(Status::kMisaligned);
    case 9:
      job.contacts.data = c.arena.add<Contact>(job.contacts.size + 1);
      put_askew(c, job.contacts.data);
      return spoiled.with(Status::kMisaligned);
    default:
      if (job.contacts.size > 0) {
        put_over(c, job.contacts.data, bytes_of(job.spheres.data, c.n));
        spoiled.with(Status::kSharedMemory);
      }
  }
}

// The deepest of the contacts written, where all are.
void check_deepest(Case& c, const ContactJob& job) {
  float greatest = 0;
  std::size_t deepest = job.contact_count;
  for (std::size_t i = 0; i < job.contact_count; ++i) {
    if (job.contacts[i].depth > greatest) {
      greatest = job.contacts[i].depth;
      deepest = i;
    }
    c.expect(job.contacts[i].pair == job.pairs[i], "a contact of another pair");
  }
  c.expect(job.deepest == deepest, "the deepest");
}

}  // namespace

void fuzz_contacts(Case& c) {
  if (!draw_asset(c)) {
    return;
  }
  ContactJob job;
  job.asset = &c.asset;
  Sphere* spheres = c.arena.add<Sphere>(c.n);
  fill_figures(c, &spheres->x, 4 * c.n);
  if (c.random.one_in(3)) spheres[c.n - 1] = spheres[0];  // in one place
  job.spheres = {spheres, c.n};
  job.pairs.size = c.n < 2 ? 0 : c.random.below(40);
  Pair* pairs = c.arena.add<Pair>(job.pairs.size);
  for (std::size_t i = 0; i < job.pairs.size; ++i) {
    const std::size_t b = 1 + c.random.up_to(c.n - 2);
    pairs[i] = {static_cast<std::uint32_t>(c.random.up_to(b - 1)), static_cast<std::uint32_t>(b)};
  }
  job.pairs.data = pairs;
  job.contacts.size = draw_capacity(c, job.pairs.size);
  job.contacts.data = c.arena.add<Contact>(job.contacts.size);
  Filter filter;
  if (c.random.one_in(2)) {
    filter = draw_filter(c);
    job.filter = &filter;
  }
  sc_contact_job c_job = SC_CONTACT_JOB_INIT;
  c_job.asset = c.c_asset;
  Spoiled spoiled;
  spoil_some(c, 11, [&](std::uint32_t way) { spoil_contacts(c, job, c_job, pairs, filter, way, spoiled); });
  const sc_filter c_filter = to_c(filter);
  c_job.spheres = reinterpret_cast<const sc_sphere*>(job.spheres.data);
  c_job.sphere_count = job.spheres.size;
  c_job.pairs = reinterpret_cast<const sc_pair*>(job.pairs.data);
  c_job.pair_count = job.pairs.size;
  c_job.filter = job.filter == nullptr ? nullptr : &c_filter;
  c_job.contacts = reinterpret_cast<sc_contact*>(job.contacts.data);
  c_job.contact_capacity = job.contacts.size;
  job.contact_count = job.deepest = c_job.contact_count = c_job.deepest = 77;
  run_both(
      c, spoiled,
      [&] {
        const Status status = job.run();
        const bool ran = status == Status::kOk || status == Status::kOverflow;
        c.expect(job.contact_count == (ran ? job.pairs.size : 77), "the count of contacts");
        c.expect((status == Status::kOverflow) == (ran && job.contacts.size > 0 && job.contacts.size < job.pairs.size),
                 "overflow");
        if (ran && job.contacts.size >= job.contact_count) check_deepest(c, job);
        return status;
      },
      [&] { return sc_contacts(&c_job); },
      [&](Status) {
        return std::vector<Bytes>{bytes_of(job.contacts.data, std::min(job.contacts.size, job.contact_count))};
      },
      [](bool) {});
  c.expect(c_job.contact_count == job.contact_count && c_job.deepest == job.deepest, "the C API counts something else");
}

}  // namespace spherechain::test
