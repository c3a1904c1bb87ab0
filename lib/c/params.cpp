// SPDX-License-Identifier: Apache-2.0
#include <memory>
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

}  // namespace
}  // namespace stein::c

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
