// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "stein/error.hpp"

namespace stein::python {
namespace {

std::string type_text(nb::handle value) {
  const nb::object type = nb::hasattr(value, "dtype") ? nb::object(value.attr("dtype")) : nb::inst_name(value);
  return nb::cast<std::string>(nb::str(type));
}

ScalarType scalar_type(nb::handle value, const InputArray& array, const std::string& what) {
  if (array.dtype() == nb::dtype<float>()) return ScalarType::kFloat32;
  if (array.dtype() == nb::dtype<std::uint32_t>()) return ScalarType::kUint32;
  const nb::dlpack::dtype half{static_cast<std::uint8_t>(nb::dlpack::dtype_code::Float), 16, 1};
  if (array.dtype() == half) return ScalarType::kFloat16;
  refuse(what + " is of type " + type_text(value) + "; views are of float32, float16 or uint32, as from " + what +
         ".astype(numpy.float32)");
}

/// Bytes from one element of an axis to the next.
std::ptrdiff_t stride_of(const InputArray& array, std::size_t axis, const std::string& what) {
  if (array.shape(axis) > 1 && array.stride(axis) == 0)
    refuse(what + " repeats its elements along axis " + std::to_string(axis) +
           "; make it a whole array with numpy.array");
  return array.stride(axis) * static_cast<std::ptrdiff_t>(array.itemsize());
}

void append_views(nb::handle value, const std::string& what, std::vector<ConstPlaneView>& views,
                  std::vector<InputArray>& owners) {
  InputArray array;
  if (!nb::try_cast(value, array, false)) {
    refuse(what + " is of type " + type_text(value) +
           ", not an array in main memory, height x width or height x width x channels");
  }
  const ScalarType type = scalar_type(value, array, what);
  if (array.ndim() < 2)
    refuse(what + " has " + std::to_string(array.ndim()) + " axes; give height x width (x channels)");
  constexpr std::size_t kMaxSide = 1U << 20;
  if (array.shape(0) - 1 >= kMaxSide || array.shape(1) - 1 >= kMaxSide || array.size() == 0) {
    refuse(what + " has " + std::to_string(array.shape(0)) + " x " + std::to_string(array.shape(1)) +
           " pixels; each side must be 1 to " + std::to_string(kMaxSide));
  }
  std::vector<std::ptrdiff_t> offsets = {0};
  for (std::size_t axis = 2; axis < array.ndim(); ++axis) {
    const std::ptrdiff_t stride = stride_of(array, axis, what);
    std::vector<std::ptrdiff_t> all;
    for (const std::ptrdiff_t offset : offsets) {
      for (std::size_t i = 0; i < array.shape(axis); ++i)
        all.push_back(offset + static_cast<std::ptrdiff_t>(i) * stride);
    }
    offsets = std::move(all);
  }
  const auto* data = static_cast<const std::byte*>(array.data());
  for (const std::ptrdiff_t offset : offsets) {
    views.emplace_back(data + offset, type, static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)),
                       stride_of(array, 1, what), stride_of(array, 0, what));
  }
  owners.push_back(std::move(array));
}

std::int64_t floats_between(const Plane& from, const Plane& to) { return to.row(0) - from.row(0); }

std::int64_t pitch_of(const Plane& plane) { return plane.row_stride() / static_cast<std::int64_t>(sizeof(float)); }

}  // namespace

void refuse(const std::string& message) { throw Error(ErrorCode::kInvalidArgument, message); }

std::vector<ConstPlaneView> views_of(nb::handle value, const std::string& what, std::vector<InputArray>& owners) {
  std::vector<ConstPlaneView> views;
  if (nb::isinstance<nb::list>(value)) {
    for (const nb::handle item : nb::borrow<nb::list>(value)) append_views(item, what, views, owners);
  } else if (!value.is_none()) {
    append_views(value, what, views, owners);
  }
  return views;
}

std::vector<ConstPlaneView> views_of(nb::handle value, const std::string& what, std::size_t count,
                                     std::vector<InputArray>& owners) {
  std::vector<ConstPlaneView> views = views_of(value, what, owners);
  if (views.size() == 1) views.resize(count, views.front());
  if (!views.empty() && views.size() != count)
    refuse(what + " has " + std::to_string(views.size()) + " channels; give " + std::to_string(count) +
           ", or 1 for all");
  return views;
}

PlaneArray array_of(Plane& plane) {
  const auto height = static_cast<std::size_t>(plane.height());
  const auto width = static_cast<std::size_t>(plane.width());
  return PlaneArray(plane.row(0), {height, width}, nb::handle(), {pitch_of(plane), 1});
}

ColourArray array_of(std::array<Plane, 3>& planes) {
  const auto height = static_cast<std::size_t>(planes[0].height());
  const auto width = static_cast<std::size_t>(planes[0].width());
  return ColourArray(planes[0].row(0), {height, width, 3}, nb::handle(),
                     {pitch_of(planes[0]), 1, floats_between(planes[0], planes[1])});
}

nb::ndarray<nb::numpy, nb::ro> array_of(const ConstPlaneView& view, nb::handle owner) {
  const auto height = static_cast<std::size_t>(view.height());
  const auto width = static_cast<std::size_t>(view.width());
  const bool is_float = view.type() != ScalarType::kUint32;
  const nb::dlpack::dtype_code code = is_float ? nb::dlpack::dtype_code::Float : nb::dlpack::dtype_code::UInt;
  const std::ptrdiff_t size = byte_size(view.type());
  const nb::dlpack::dtype type{static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(8 * size), 1};
  return nb::ndarray<nb::numpy, nb::ro>(view.data(), {height, width}, owner,
                                        {view.row_stride() / size, view.pixel_stride() / size}, type);
}

}  // namespace stein::python
