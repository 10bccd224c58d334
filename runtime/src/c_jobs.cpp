// SPDX-License-Identifier: MIT
// The C API's jobs: a C++ job filled in, run, and its counts handed back.
#include "c_api.h"
#include "spherechain/contacts.h"
#include "spherechain/cover.h"
#include "spherechain/crowd.h"
#include "spherechain/detect.h"
#include "spherechain/refit.h"
#include "spherechain/skin.h"

using namespace spherechain;

namespace {

static_assert(SC_METHOD_M1 == static_cast<int>(Method::kM1) && SC_METHOD_M2 == static_cast<int>(Method::kM2));
static_assert(SC_VERTICES_SOURCE == static_cast<int>(VertexSet::kSource) &&
              SC_VERTICES_PIVOTS == static_cast<int>(VertexSet::kPivots));
static_assert(SC_ROW_MAJOR_3X4 == static_cast<int>(MatrixLayout::kRowMajor3x4) &&
              SC_ROW_MAJOR_4X4 == static_cast<int>(MatrixLayout::kRowMajor4x4) &&
              SC_COLUMN_MAJOR_4X4 == static_cast<int>(MatrixLayout::kColumnMajor4x4) &&
              SC_COLUMN_MAJOR_3X4 == static_cast<int>(MatrixLayout::kColumnMajor3x4));
static_assert(offsetof(Sphere, radius) == offsetof(sc_sphere, radius) && offsetof(Pair, b) == offsetof(sc_pair, b) &&
              offsetof(ChainPair, pair) == offsetof(sc_chain_pair, pair) &&
              offsetof(CrowdPair, pair) == offsetof(sc_crowd_pair, pair));
static_assert(offsetof(Contact, depth) == offsetof(sc_contact, depth) &&
              offsetof(Contact, severity) == offsetof(sc_contact, severity) &&
              offsetof(Contact, normal) == offsetof(sc_contact, normal) &&
              offsetof(Contact, point) == offsetof(sc_contact, point) &&
              offsetof(Contact, triangles_a) == offsetof(sc_contact, triangles_a) &&
              offsetof(Contact, triangles_b) == offsetof(sc_contact, triangles_b));

}  // namespace

extern "C" {

sc_status sc_refit(const sc_refit_job* job) {
  if (const sc_status status = check_job(job); status != SC_OK) {
    return status;
  }
  RefitJob refit;
  refit.asset = &job->asset->view;
  refit.positions = job->positions;
  refit.vertex_count = job->vertex_count;
  refit.stride = job->stride;
  refit.vertices = to_enum<VertexSet>(job->vertices);
  refit.radius = to_enum<RadiusKind>(job->radius);
  refit.spheres = to_span<Sphere>(job->spheres, job->sphere_count);
  return to_c(refit.run());
}

sc_status sc_refit_bones(const sc_refit_bones_job* job) {
  if (const sc_status status = check_job(job); status != SC_OK) {
    return status;
  }
  RefitBonesJob refit;
  refit.asset = &job->asset->view;
  refit.bones = to_cpp(job->bones);
  refit.morph_weights = {job->morph_weights, job->morph_weight_count};
  refit.radius = to_enum<RadiusKind>(job->radius);
  refit.target = to_enum<Target>(job->target);
  refit.spheres = to_span<Sphere>(job->spheres, job->sphere_count);
  return to_c(refit.run());
}

sc_status sc_cover(const sc_cover_job* job) {
  if (const sc_status status = check_job(job); status != SC_OK) {
    return status;
  }
  CoverJob cover;
  cover.asset = &job->asset->view;
  cover.bones = to_cpp(job->bones);
  cover.morph_weights = {job->morph_weights, job->morph_weight_count};
  cover.target = to_enum<Target>(job->target);
  cover.leaves = to_span<Sphere>(job->leaves, job->leaf_count);
  cover.spheres = to_span<Sphere>(job->spheres, job->sphere_count);
  return to_c(cover.run());
}

sc_status sc_skin(const sc_skin_job* job) {
  if (const sc_status status = check_job(job); status != SC_OK) {
    return status;
  }
  SkinJob skin;
  skin.asset = &job->asset->view;
  skin.bones = to_cpp(job->bones);
  skin.morph_weights = {job->morph_weights, job->morph_weight_count};
  skin.target = to_enum<Target>(job->target);
  skin.positions = job->positions;
  skin.vertex_count = job->vertex_count;
  skin.stride = job->stride;
  return to_c(skin.run());
}

size_t sc_detect_scratch_words(const sc_asset* asset) {
  return asset == nullptr ? 0 : DetectContext::words_needed(asset->view);
}

size_t sc_detect_bit_words(const sc_asset* asset) { return asset == nullptr ? 0 : DetectJob::bit_words(asset->view); }

size_t sc_detect_table_words(const sc_asset* asset) {
  return asset == nullptr ? 0 : DetectTable::words_needed(asset->view);
}

sc_status sc_prepare_detect(const sc_asset* asset, sc_radius radius, const sc_filter* filter, uint64_t* table,
                            size_t table_words) {
  if (asset == nullptr) {
    return SC_NULL_ARGUMENT;
  }
  const FilterView view(filter);
  DetectTable out{{table, table_words}};
  return to_c(prepare_detect(asset->view, to_enum<RadiusKind>(radius), view.get(), out));
}

sc_status sc_detect(sc_detect_job* job) {
  if (const sc_status status = check_job(job); status != SC_OK) {
    return status;
  }
  const FilterView filter(job->filter);
  DetectContext context{{job->scratch, job->scratch_words}};
  const DetectTable table{{job->table, job->table_words}};
  DetectJob detect;
  detect.asset = &job->asset->view;
  detect.spheres = to_span<const Sphere>(job->spheres, job->sphere_count);
  detect.radius = to_enum<RadiusKind>(job->radius);
  detect.method = to_enum<Method>(job->method);
  detect.target = to_enum<Target>(job->target);
  detect.filter = filter.get();
  detect.table = job->table == nullptr ? nullptr : &table;
  detect.first_only = job->first_only != 0;
  detect.context = job->scratch == nullptr ? nullptr : &context;
  detect.pairs = to_span<Pair>(job->pairs, job->pair_capacity);
  detect.bits = {job->bits, job->bit_words};
  detect.chain_pairs = to_span<ChainPair>(job->chain_pairs, job->chain_pair_capacity);
  detect.pair_count = job->pair_count;
  detect.chain_pair_count = job->chain_pair_count;
  detect.test_count = job->test_count;
  const Status status = detect.run();
  job->pair_count = detect.pair_count;
  job->chain_pair_count = detect.chain_pair_count;
  job->test_count = detect.test_count;
  return to_c(status);
}

sc_status sc_contacts(sc_contact_job* job) {
  if (const sc_status status = check_job(job); status != SC_OK) {
    return status;
  }
  const FilterView filter(job->filter);
  ContactJob contact;
  contact.asset = &job->asset->view;
  contact.spheres = to_span<const Sphere>(job->spheres, job->sphere_count);
  contact.pairs = to_span<const Pair>(job->pairs, job->pair_count);
  contact.filter = filter.get();
  contact.contacts = to_span<Contact>(job->contacts, job->contact_capacity);
  contact.contact_count = job->contact_count;
  contact.deepest = job->deepest;
  const Status status = contact.run();
  job->contact_count = contact.contact_count;
  job->deepest = contact.deepest;
  return to_c(status);
}

size_t sc_crowd_scratch_words(const sc_asset* asset, size_t task_count) {
  return asset == nullptr ? 0 : CrowdContext::words_needed(asset->view, task_count);
}

sc_status sc_crowd(sc_crowd_job* job) {
  if (const sc_status status = check_job(job); status != SC_OK) {
    return status;
  }
  const FilterView filter(job->filter);
  CrowdContext context{{job->scratch, job->scratch_words}};
  CrowdJob crowd;
  crowd.asset = &job->asset->view;
  crowd.spheres = to_span<const Sphere>(job->spheres, 0).data;
  crowd.instance_count = job->instance_count;
  crowd.stride = job->stride;
  crowd.bones = to_cpp(job->bones);
  crowd.instance_stride = job->instance_stride;
  crowd.morph_weights = {job->morph_weights, job->morph_weight_count};
  crowd.radius = to_enum<RadiusKind>(job->radius);
  crowd.target = to_enum<Target>(job->target);
  crowd.filter = filter.get();
  crowd.context = job->scratch == nullptr ? nullptr : &context;
  crowd.hook = {job->parallel_for, job->user};
  crowd.task_count = job->task_count;
  crowd.counts = {job->counts, job->counts_capacity};
  crowd.bits = {job->bits, job->bit_words};
  crowd.pairs = to_span<CrowdPair>(job->pairs, job->pair_capacity);
  crowd.pair_count = job->pair_count;
  const Status status = crowd.run();
  job->pair_count = crowd.pair_count;
  return to_c(status);
}

}  // extern "C"
