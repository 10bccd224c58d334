// SPDX-License-Identifier: MIT
// The C API's filters.
#include "c_api.h"

using namespace spherechain;

namespace {

// `edit` gets the asset and a C++ view of the filter's buffers.
template <typename Edit>
sc_status edit_filter(const sc_asset* asset, const sc_filter* filter, Edit edit) {
  if (asset == nullptr || filter == nullptr) {
    return SC_NULL_ARGUMENT;
  }
  Filter view = to_cpp(*filter);
  return to_c(edit(asset->view, view));
}

}  // namespace

extern "C" {

size_t sc_filter_ignored_words(const sc_asset* asset) {
  return asset == nullptr ? 0 : Filter::ignored_words(asset->view);
}

size_t sc_filter_disabled_words(const sc_asset* asset) {
  return asset == nullptr ? 0 : Filter::disabled_words(asset->view);
}

sc_status sc_check_filter(const sc_asset* asset, const sc_filter* filter) {
  return edit_filter(asset, filter, [](const Asset& view, Filter& edited) { return check_filter(view, edited); });
}

sc_status sc_reset_filter(const sc_asset* asset, sc_filter* filter) {
  return edit_filter(asset, filter, [](const Asset& view, Filter& edited) { return reset_filter(view, edited); });
}

sc_status sc_ignore_pair(const sc_asset* asset, sc_filter* filter, uint32_t a, uint32_t b, int ignored) {
  return edit_filter(asset, filter,
                     [=](const Asset& view, Filter& edited) { return ignore_pair(view, edited, a, b, ignored != 0); });
}

sc_status sc_ignore_regions(const sc_asset* asset, sc_filter* filter, size_t region, size_t other, int ignored) {
  return edit_filter(asset, filter, [=](const Asset& view, Filter& edited) {
    return ignore_regions(view, edited, region, other, ignored != 0);
  });
}

sc_status sc_ignore_hops(const sc_asset* asset, sc_filter* filter, size_t hops, int ignored) {
  return edit_filter(asset, filter,
                     [=](const Asset& view, Filter& edited) { return ignore_hops(view, edited, hops, ignored != 0); });
}

sc_status sc_disable_sphere(const sc_asset* asset, sc_filter* filter, uint32_t sphere, int disabled) {
  return edit_filter(asset, filter, [=](const Asset& view, Filter& edited) {
    return disable_sphere(view, edited, sphere, disabled != 0);
  });
}

sc_status sc_pad_sphere(const sc_asset* asset, sc_filter* filter, uint32_t sphere, float padding) {
  return edit_filter(asset, filter,
                     [=](const Asset& view, Filter& edited) { return pad_sphere(view, edited, sphere, padding); });
}

}  // extern "C"
