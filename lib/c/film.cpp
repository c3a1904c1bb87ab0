// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "c/boundary.hpp"
#include "c/handles.hpp"

namespace stein::c {
namespace {

SampleLayout layout_of(const char* const* names, const int32_t* channels, int32_t features) {
  if (features < 0) refuse("the number of features is " + std::to_string(features) + "; it must be 0 or more");
  if (features > 0) {
    require(names, "the list of names");
    require(channels, "the list of channels");
  }
  SampleLayout layout;
  for (int32_t i = 0; i < features; ++i) {
    require(names[i], "a name");
    require_no_dot(names[i]);
    layout.features.push_back({names[i], channels[i]});
  }
  return layout;
}

}  // namespace
}  // namespace stein::c

using stein::c::guarded;
using stein::c::guarded_make;
using stein::c::layout_of;
using stein::c::make_slots;
using stein::c::refuse;
using stein::c::require;

stein_status stein_film_create(int32_t width, int32_t height, const char* const* names, const int32_t* channels,
                               int32_t features, stein_film** film) {
  return guarded_make("stein_film_create", film, [&] {
    stein::Accumulator value(width, height, layout_of(names, channels, features));
    return std::make_unique<stein_film>(stein_film{std::move(value)}).release();
  });
}

void stein_film_destroy(stein_film* film) { delete film; }

stein_status stein_film_add(stein_film* film, int32_t x, int32_t y, const float* sample) {
  return guarded("stein_film_add", [&] {
    require(film, "the film");
    require(sample, "the sample");
    stein::Accumulator& value = film->value;
    if (x < 0 || y < 0 || x >= value.width() || y >= value.height()) {
      refuse("pixel (" + std::to_string(x) + ", " + std::to_string(y) + ") is outside the film of " +
             std::to_string(value.width()) + "x" + std::to_string(value.height()));
    }
    value.add(x, y, sample);
  });
}

stein_status stein_film_merge(stein_film* film, const stein_film* other) {
  return guarded("stein_film_merge", [&] {
    require(film, "the film");
    require(other, "the other film");
    if (film == other) refuse("both films are the same; its samples would count twice");
    film->value.merge(other->value);
  });
}

stein_status stein_film_number(const stein_film* film, const char* name, double* value) {
  return guarded("stein_film_number", [&] {
    require(film, "the film");
    require(name, "the name");
    require(value, "the address for the number");
    const std::string_view wanted = name;
    if (wanted != "rejected" && wanted != "repaired")
      refuse("a film has no number '" + std::string(wanted) + "'; it has: rejected repaired");
    *value = static_cast<double>(wanted == "rejected" ? film->value.rejected() : film->value.repaired());
  });
}

stein_status stein_film_frame(const stein_film* film, stein_frame** frame) {
  return guarded_make("stein_film_frame", frame, [&] {
    require(film, "the film");
    auto made = std::make_unique<stein_frame>();
    made->slots = made->memory.emplace(film->value.moments()).frame();
    for (stein::Feature& feature : made->slots.features) make_slots(feature);
    return made.release();
  });
}
