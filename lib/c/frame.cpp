// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "c/boundary.hpp"
#include "c/handles.hpp"
#include "core/parameter_check.hpp"
#include "core/plane_slots.hpp"

namespace stein::c {
namespace {

ScalarType scalar_type(stein_type type) {
  switch (type) {
    case STEIN_FLOAT32:
      return ScalarType::kFloat32;
    case STEIN_FLOAT16:
      return ScalarType::kFloat16;
    case STEIN_UINT32:
      return ScalarType::kUint32;
    default:
      refuse("there is no type " + std::to_string(type) + "; use STEIN_FLOAT32, STEIN_FLOAT16 or STEIN_UINT32");
  }
}

template <class Visit>
void for_each_plane(Frame& frame, const Visit& visit) {
  for_each_colour_slot(frame, visit);
  for (Feature& feature : frame.features) for_each_slot(feature, visit);
  for (Layer& layer : frame.layers) {
    for (std::size_t c = 0; c < layer.mean.size(); ++c) visit(plane_name(layer, c), layer.mean[c]);
  }
}

ConstPlaneView& slot(Frame& frame, const std::string& wanted) {
  ConstPlaneView* found = nullptr;
  std::string names;
  const auto compare = [&](const std::string& name, ConstPlaneView& view) {
    if (name == wanted) found = &view;
    names += " " + name;
  };
  for_each_plane(frame, compare);
  if (found == nullptr) {
    refuse(
        "the frame has no plane '" + wanted +
        "'; declare features with stein_frame_add_feature, layers with stein_frame_add_layer first. It has:" + names);
  }
  return *found;
}

// A plane that was set.
ConstPlaneView plane_of(const Frame& frame, const char* wanted) {
  require(wanted, "the name");
  std::string names;
  for (const auto& [name, view] : named_planes(frame)) {
    if (name == wanted) return view;
    names += " " + name;
  }
  refuse(std::string("the frame has no plane '") + wanted + "'; it has:" + names);
}

void drop_if_absent(std::vector<ConstPlaneView>& views) {
  if (std::none_of(views.begin(), views.end(), [](const ConstPlaneView& view) { return static_cast<bool>(view); }))
    views.clear();
}

void add_feature(Frame& frame, const std::string& name, int channels) {
  check(SampleLayout{{{name, channels}}});
  require_no_dot(name);
  if (std::any_of(frame.features.begin(), frame.features.end(), [&](const Feature& f) { return f.name == name; }))
    refuse("the frame has a feature '" + name + "' already; names must be unique");
  Feature feature{name, std::vector<ConstPlaneView>(static_cast<std::size_t>(channels)), {}, {}};
  make_slots(feature);
  frame.features.push_back(std::move(feature));
}

bool has_plane(Frame& frame, const std::string& wanted) {
  bool found = false;
  for_each_plane(frame, [&](const std::string& name, const ConstPlaneView&) { found = found || name == wanted; });
  return found;
}

void add_layer(Frame& frame, const std::string& name, int channels) {
  if (name.empty()) refuse("a layer has no name");
  if (channels != 1 && channels != 3)
    refuse("layer '" + name + "' has " + std::to_string(channels) + " channels; 3 or 1 are possible");
  Layer layer{name, std::vector<ConstPlaneView>(static_cast<std::size_t>(channels))};
  for (std::size_t c = 0; c < layer.mean.size(); ++c) {
    if (has_plane(frame, plane_name(layer, c)))
      refuse("the frame has a plane '" + plane_name(layer, c) + "' already; give the layer another name");
  }
  frame.layers.push_back(std::move(layer));
}

}  // namespace

void make_slots(Feature& feature) {
  feature.variance.resize(feature.mean.size());
  feature.colour_covariance.resize(3 * feature.mean.size());
}

Frame frame_of(const stein_frame* handle) {
  require(handle, "the frame");
  Frame frame = handle->slots;
  for (Feature& feature : frame.features) {
    drop_if_absent(feature.variance);
    drop_if_absent(feature.colour_covariance);
  }
  return frame;
}

}  // namespace stein::c

using stein::c::add_feature;
using stein::c::add_layer;
using stein::c::guarded;
using stein::c::guarded_make;
using stein::c::plane_of;
using stein::c::refuse;
using stein::c::require;
using stein::c::require_strides;
using stein::c::scalar_type;
using stein::c::slot;

stein_status stein_frame_create(int32_t width, int32_t height, stein_frame** frame) {
  return guarded_make("stein_frame_create", frame, [&] {
    constexpr int32_t kMaxSide = 1 << 20;
    if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
      refuse("the size is " + std::to_string(width) + "x" + std::to_string(height) + "; each side must be 1 to " +
             std::to_string(kMaxSide));
    }
    auto made = std::make_unique<stein_frame>();
    made->slots.width = width;
    made->slots.height = height;
    return made.release();
  });
}

void stein_frame_destroy(stein_frame* frame) { delete frame; }

stein_status stein_frame_add_feature(stein_frame* frame, const char* name, int32_t channels) {
  return guarded("stein_frame_add_feature", [&] {
    require(frame, "the frame");
    require(name, "the name");
    add_feature(frame->slots, name, channels);
  });
}

stein_status stein_frame_add_layer(stein_frame* frame, const char* name, int32_t channels) {
  return guarded("stein_frame_add_layer", [&] {
    require(frame, "the frame");
    require(name, "the name");
    add_layer(frame->slots, name, channels);
  });
}

stein_status stein_frame_set_plane(stein_frame* frame, const char* name, stein_type type, const void* data,
                                   ptrdiff_t pixel_stride, ptrdiff_t row_stride) {
  return guarded("stein_frame_set_plane", [&] {
    require(frame, "the frame");
    require(name, "the name");
    require(data, (std::string("the data of plane '") + name + "'").c_str());
    const stein::ScalarType scalar = scalar_type(type);
    stein::Frame& slots = frame->slots;
    require_strides(name, stein::byte_size(scalar), pixel_stride, row_stride, slots.width);
    slot(slots, name) = stein::ConstPlaneView(data, scalar, slots.width, slots.height, pixel_stride, row_stride);
  });
}

stein_status stein_frame_copy(const stein_frame* frame, const char* name, float* to, ptrdiff_t pixel_stride,
                              ptrdiff_t row_stride) {
  return guarded("stein_frame_copy", [&] {
    const stein::ConstPlaneView plane = plane_of(stein::c::frame_of(frame), name);
    require(to, "the memory to copy to");
    require_strides(name, sizeof(float), pixel_stride, row_stride, plane.width());
    const stein::PlaneView view(to, plane.width(), plane.height(), pixel_stride, row_stride);
    std::vector<float> row(static_cast<std::size_t>(plane.width()));
    for (int y = 0; y < plane.height(); ++y) {
      plane.read_row(y, 0, plane.width(), row.data());
      view.write_row(y, 0, plane.width(), row.data());
    }
  });
}

stein_status stein_frame_set_sample_count(stein_frame* frame, float samples) {
  return guarded("stein_frame_set_sample_count", [&] {
    require(frame, "the frame");
    stein::require_in_range("the sample count", samples, 1.0F, std::numeric_limits<float>::max());
    frame->slots.uniform_sample_count = samples;
    frame->slots.sample_count = {};
  });
}

stein_status stein_frame_set_degrees_of_freedom(stein_frame* frame, float degrees) {
  return guarded("stein_frame_set_degrees_of_freedom", [&] {
    require(frame, "the frame");
    stein::require_not_negative("the degrees of freedom", degrees);
    frame->slots.degrees_of_freedom = degrees;
  });
}
