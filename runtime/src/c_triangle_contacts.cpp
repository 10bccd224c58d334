// SPDX-License-Identifier: MIT
// The C API's jobs on the triangles of the skin.
#include "c_api.h"
#include "spherechain/confirm.h"
#include "spherechain/detect_skin.h"
#include "spherechain/triangle_contacts.h"

using namespace spherechain;

namespace {

static_assert(SC_CONTACTS_APART == static_cast<int>(ContactScope::kApart) &&
              SC_CONTACTS_OF_NEIGHBOURS == static_cast<int>(ContactScope::kNeighbours) &&
              SC_CONTACTS_ALL == static_cast<int>(ContactScope::kAll));
static_assert(offsetof(TrianglePair, b) == offsetof(sc_triangle_pair, b));
constexpr std::size_t kOverlap = offsetof(TriangleContact, overlap);
static_assert(kOverlap + offsetof(TriangleOverlap, from) == offsetof(sc_triangle_contact, from) &&
              kOverlap + offsetof(TriangleOverlap, to) == offsetof(sc_triangle_contact, to) &&
              kOverlap + offsetof(TriangleOverlap, normal) == offsetof(sc_triangle_contact, normal) &&
              kOverlap + offsetof(TriangleOverlap, depth) == offsetof(sc_triangle_contact, depth));
static_assert(offsetof(SphereContact, count) == offsetof(sc_sphere_contact, count) &&
              offsetof(SphereContact, deepest) == offsetof(sc_sphere_contact, deepest));

// The pose, as all these jobs have it.
template <typename Cpp, typename C>
void set_pose(Cpp& out, const C& job) {
  out.asset = &job.asset->view;
  out.positions = job.positions;
  out.vertex_count = job.vertex_count;
  out.stride = job.stride;
  out.bones = to_cpp(job.bones);
  out.morph_weights = {job.morph_weights, job.morph_weight_count};
  out.target = to_enum<Target>(job.target);
}

}  // namespace

extern "C" {

size_t sc_triangle_contact_scratch_words(const sc_asset* asset) {
  return asset == nullptr ? 0 : TriangleContactContext::words_needed(asset->view);
}

sc_status sc_triangle_contacts(sc_triangle_contact_job* job) {
  if (const sc_status status = check_job(job); status != SC_OK) {
    return status;
  }
  const FilterView filter(job->filter);
  TriangleContactContext context{{job->scratch, job->scratch_words}};
  TriangleContactJob contacts;
  set_pose(contacts, *job);
  contacts.filter = filter.get();
  contacts.scope = to_enum<ContactScope>(job->scope);
  contacts.context = job->scratch == nullptr ? nullptr : &context;
  contacts.pairs = to_span<TrianglePair>(job->pairs, job->pair_capacity);
  contacts.contacts = to_span<TriangleContact>(job->contacts, job->contact_capacity);
  contacts.sphere_contacts = to_span<SphereContact>(job->sphere_contacts, job->sphere_contact_capacity);
  contacts.pair_count = job->pair_count;
  contacts.sphere_contact_count = job->sphere_contact_count;
  const Status status = contacts.run();
  job->pair_count = contacts.pair_count;
  job->sphere_contact_count = contacts.sphere_contact_count;
  return to_c(status);
}

sc_status sc_detect_skin(sc_detect_skin_job* job) {
  if (const sc_status status = check_job(job); status != SC_OK) {
    return status;
  }
  const FilterView filter(job->filter);
  TriangleContactContext context{{job->scratch, job->scratch_words}};
  DetectSkinJob detect;
  set_pose(detect, *job);
  detect.filter = filter.get();
  detect.context = job->scratch == nullptr ? nullptr : &context;
  detect.pairs = to_span<Pair>(job->pairs, job->pair_capacity);
  detect.pair_count = job->pair_count;
  const Status status = detect.run();
  job->pair_count = detect.pair_count;
  return to_c(status);
}

sc_status sc_confirm(sc_confirm_job* job) {
  if (const sc_status status = check_job(job); status != SC_OK) {
    return status;
  }
  TriangleContactContext context{{job->scratch, job->scratch_words}};
  ConfirmJob confirm;
  set_pose(confirm, *job);
  confirm.candidates = to_span<const Pair>(job->candidates, job->candidate_count);
  confirm.context = job->scratch == nullptr ? nullptr : &context;
  confirm.pairs = to_span<Pair>(job->pairs, job->pair_capacity);
  confirm.pair_count = job->pair_count;
  const Status status = confirm.run();
  job->pair_count = confirm.pair_count;
  return to_c(status);
}

}  // extern "C"
