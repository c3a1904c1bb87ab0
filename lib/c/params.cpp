// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "c/boundary.hpp"
#include "c/handles.hpp"
#include "core/filter_options.hpp"
#include "stein/options.hpp"

namespace stein::c {
namespace {

// On a copy: what fails changes nothing.
template <class Set>
void change(stein_params* params, const char* name, const Set& set) {
  require(params, "the parameters");
  require(name, "the name");
  stein_params changed = *params;
  set(changed);
  check(changed.values);
  *params = std::move(changed);
}

// A denoiser of C as one of C++.
struct CDenoiser {
  std::string name;
  stein_denoiser run;
  void* user;

  std::array<Plane, 3> operator()(const Frame& frame) const {
    std::array<Plane, 3> image = Plane::triple(frame.width, frame.height);
    float* const planes[3] = {image[0].row(0), image[1].row(0), image[2].row(0)};
    const stein_frame handle{frame, std::nullopt};
    if (run(&handle, planes, image[0].row_stride(), user) == 0) refuse("the denoiser '" + name + "' failed");
    return image;
  }
};

}  // namespace
}  // namespace stein::c

using stein::c::CDenoiser;
using stein::c::change;
using stein::c::guarded;
using stein::c::guarded_make;
using stein::c::require;

stein_status stein_params_create(const char* filter, stein_params** params) {
  return guarded_make("stein_params_create", params, [&] {
    auto made = std::make_unique<stein_params>();
    if (filter != nullptr) made->values.filters = stein::make_filters(filter);
    return made.release();
  });
}

void stein_params_destroy(stein_params* params) { delete params; }

stein_status stein_params_set_text(stein_params* params, const char* name, const char* value) {
  return guarded("stein_params_set_text", [&] {
    require(value, "the value");
    change(params, name, [&](stein_params& changed) { stein::set_option(changed.values, name, std::string(value)); });
  });
}

stein_status stein_params_set_number(stein_params* params, const char* name, double value) {
  return guarded("stein_params_set_number", [&] {
    change(params, name, [&](stein_params& changed) {
      stein::set_option(changed.values, name, value);
      if (const auto feature = stein::feature_of_option(name); !feature.empty()) changed.guiding.emplace_back(feature);
    });
  });
}

stein_status stein_params_add_denoiser(stein_params* params, const char* name, stein_denoiser denoiser, void* user,
                                       int32_t draws, float step, uint64_t seed) {
  return guarded("stein_params_add_denoiser", [&] {
    if (denoiser == nullptr) stein::c::refuse("the denoiser is null");
    change(params, name, [&](stein_params& changed) {
      stein::ExternalDenoiser external;
      external.run = CDenoiser{name, denoiser, user};
      external.draws = draws;
      if (step != 0.0F) external.step = step;
      external.seed = seed;
      changed.values.candidates.push_back({name, external});
    });
  });
}
