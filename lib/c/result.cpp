// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "c/boundary.hpp"
#include "c/handles.hpp"

namespace stein::c {
namespace {

// What a result has of a kind, by name.
template <class Value>
using Table = std::vector<std::pair<std::string, Value>>;

template <class Value>
Value look_up(const Table<Value>& table, const char* kind, const char* name) {
  require(name, "the name");
  std::string names;
  for (const auto& [known, value] : table) {
    if (name == known) return value;
    names += " " + known;
  }
  refuse(std::string("a result has no ") + kind + " '" + name + "'; it has:" + names);
}

const Plane& plane_of(const stein_result* result, const char* name) {
  require(result, "the result");
  const DenoiseResult& r = result->value;
  Table<const Plane*> planes = {{"R", &r.colour.at(0)},      {"G", &r.colour.at(1)},      {"B", &r.colour.at(2)},
                                {"error.R", &r.error.at(0)}, {"error.G", &r.error.at(1)}, {"error.B", &r.error.at(2)},
                                {"choice.V", &r.choice},     {"density.V", &r.density}};
  for (const FilteredLayer& layer : r.layers) {
    for (std::size_t c = 0; c < layer.mean.size(); ++c) planes.emplace_back(plane_name(layer, c), &layer.mean[c]);
  }
  return *look_up(planes, "plane", name);
}

double number_of(const stein_result* result, const char* name) {
  require(result, "the result");
  const DenoiseReport& report = result->value.report;
  const std::vector<std::int64_t>& bad_layers = report.frame.bad_layer_pixels;
  const auto bad_layer_pixels = std::accumulate(bad_layers.begin(), bad_layers.end(), std::int64_t{0});
  Table<double> numbers = {{"invalid_pixels", static_cast<double>(report.frame.invalid_pixels)},
                           {"single_sample_pixels", static_cast<double>(report.frame.single_sample_pixels)},
                           {"outlier_pixels", static_cast<double>(report.outlier_pixels)},
                           {"outlier_energy", report.outlier_energy},
                           {"scratch_bytes", static_cast<double>(report.scratch_bytes)},
                           {"mean_error.R", report.mean_error[0]},
                           {"mean_error.G", report.mean_error[1]},
                           {"mean_error.B", report.mean_error[2]},
                           {"mean_relative_error", report.mean_relative_error},
                           {"bad_layer_pixels", static_cast<double>(bad_layer_pixels)}};
  for (const FilterShare& filter : report.filters) {
    numbers.emplace_back("weight." + filter.name, filter.weight);
    if (filter.mean_relative_error)
      numbers.emplace_back("mean_relative_error." + filter.name, *filter.mean_relative_error);
  }
  return look_up(numbers, "number", name);
}

const char* text_of(const stein_result* result, const char* name, int32_t index) {
  require(result, "the result");
  if (index < 0) refuse("the index is " + std::to_string(index) + "; it starts from 0");
  const DenoiseReport& report = result->value.report;
  const auto i = static_cast<std::size_t>(index);
  const auto entry = [&](const std::vector<std::string>& list) { return i < list.size() ? list[i].c_str() : nullptr; };
  const auto filter = [&](std::string FilterShare::*text) {
    return i < report.filters.size() ? (report.filters[i].*text).c_str() : nullptr;
  };
  return look_up<const char*>({{"warning", entry(report.warnings)},
                               {"candidate", entry(report.candidates)},
                               {"filter", filter(&FilterShare::name)},
                               {"risk", filter(&FilterShare::risk)},
                               {"risk_reason", filter(&FilterShare::risk_reason)}},
                              "text", name);
}

}  // namespace
}  // namespace stein::c

using stein::c::guarded;
using stein::c::number_of;
using stein::c::plane_of;
using stein::c::require;
using stein::c::require_strides;
using stein::c::text_of;

stein_status stein_result_plane(const stein_result* result, const char* name, const float** data,
                                ptrdiff_t* row_stride) {
  return guarded("stein_result_plane", [&] {
    require(data, "the address for the plane");
    *data = nullptr;
    require(row_stride, "the address for the row stride");
    const stein::Plane& plane = plane_of(result, name);
    *data = plane.row(0);
    *row_stride = plane.row_stride();
  });
}

stein_status stein_result_copy(const stein_result* result, const char* name, float* to, ptrdiff_t pixel_stride,
                               ptrdiff_t row_stride) {
  return guarded("stein_result_copy", [&] {
    const stein::Plane& plane = plane_of(result, name);
    require(to, "the memory to copy to");
    require_strides(name, sizeof(float), pixel_stride, row_stride, plane.width());
    const stein::PlaneView view(to, plane.width(), plane.height(), pixel_stride, row_stride);
    for (int y = 0; y < plane.height(); ++y) view.write_row(y, 0, plane.width(), plane.row(y));
  });
}

stein_status stein_result_number(const stein_result* result, const char* name, double* value) {
  return guarded("stein_result_number", [&] {
    require(value, "the address for the number");
    *value = number_of(result, name);
  });
}

stein_status stein_result_text(const stein_result* result, const char* name, int32_t index, const char** text) {
  return guarded("stein_result_text", [&] {
    require(text, "the address for the text");
    *text = nullptr;
    *text = text_of(result, name, index);
  });
}
