// SPDX-License-Identifier: Apache-2.0
//
// Any calls of stein.h with any arguments that a caller can get wrong: null, names, numbers, sizes and strides. Each
// may only return a status. Pointers that are not null point to enough memory, as a caller has to promise.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <string>

#include "input.hpp"
#include "stein.h"

namespace {

constexpr int32_t kMostPixels = 12;  // of a side
constexpr std::size_t kMemory = 1 << 14;

/// A value of the range that is meant, or any at all.
int32_t side(stein::fuzz::Values& values) {
  const auto any = values.take<int32_t>();
  const bool is_hostile = any % 8 == 7;
  return is_hostile ? std::min(any, 0) : std::abs(any % kMostPixels) + 1;
}

/// A denoiser of the caller's: what it does is said by the byte that `user` points to.
int any_denoiser(const stein_frame* frame, float* const colour[3], ptrdiff_t row_stride, void* user) {
  enum { kFails, kUnusable, kUnknownPlane, kLeavesZeros, kHuge, kKinds };
  const int kind = *static_cast<const std::uint8_t*>(user) % (kKinds + 4);  // most often it does what it should
  constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};
  if (kind == kFails) return 0;
  if (kind == kLeavesZeros) return 1;
  for (std::size_t c = 0; c < 3; ++c) {
    const char* name = kind == kUnknownPlane ? "none" : kRgb[c];
    if (stein_frame_copy(frame, name, colour[c], 0, row_stride) != STEIN_OK && kind != kUnknownPlane) return 0;
    if (kind == kUnusable) colour[c][0] = std::numeric_limits<float>::quiet_NaN();
    if (kind == kHuge) colour[c][0] = std::numeric_limits<float>::max();
  }
  return 1;
}

/// Handles and memory of one run of calls.
class Caller {
 public:
  explicit Caller(stein::fuzz::Values values) : values_(values) {
    for (std::size_t i = 0; i < kMemory; ++i) memory_[i] = 0.25F * static_cast<float>(i % 13);
  }
  Caller(const Caller&) = delete;
  Caller& operator=(const Caller&) = delete;
  ~Caller() {
    stein_frame_destroy(frame_);
    stein_params_destroy(params_);
    stein_result_destroy(result_);
    for (stein_film* film : films_) stein_film_destroy(film);
  }

  void run() {
    if (stein_version() != STEIN_VERSION) std::abort();
    constexpr int kMostCalls = 64;
    for (int i = 0; i < kMostCalls && !values_.at_end(); ++i) {
      const auto number = values_.take<std::uint8_t>();
      (this->*kCalls[number % kCalls.size()])();
      if (std::string(stein_error_message()).size() > 2047) std::abort();
    }
  }

 private:
  using Call = void (Caller::*)();

  void make_frame() {
    stein_frame_destroy(frame_);
    const int32_t width = side(values_);
    const int32_t height = side(values_);
    is_safe_ = true;
    if (stein_frame_create(width, height, &frame_) != STEIN_OK && frame_ != nullptr) std::abort();
  }

  void add_feature() {
    const auto channels = values_.take<int8_t>();
    stein_frame_add_feature(frame_, values_.text().c_str(), channels);
  }

  void add_layer() {
    const auto channels = values_.take<int8_t>();
    stein_frame_add_layer(frame_, values_.text().c_str(), channels);
  }

  static ptrdiff_t small_stride(std::uint8_t kind) {
    constexpr std::array<ptrdiff_t, 8> kSmall = {0, 0, 4, 8, 12, 48, 2, 192};
    return kSmall[kind % kSmall.size()];
  }

  ptrdiff_t stride() {
    const auto kind = values_.take<std::uint8_t>();
    return kind < 200 ? small_stride(kind) : values_.take<ptrdiff_t>();
  }

  void set_plane() {
    const auto type = static_cast<stein_type>(values_.take<std::uint8_t>() % 4);
    const ptrdiff_t pixel = stride();
    const ptrdiff_t row = stride();
    const std::string name = values_.text();
    const stein_status status = stein_frame_set_plane(frame_, name.c_str(), type, memory_.data(), pixel, row);
    // What is accepted but larger than the memory is the caller's word against it; it must not be read.
    const bool is_within = pixel >= 0 && pixel <= 48 && row >= 0 && row <= 192;
    if (status == STEIN_OK && !is_within) is_safe_ = false;
  }

  /// All planes that a frame needs.
  void set_colour() {
    for (const char* name : {"R", "G", "B", "variance.R", "variance.G", "variance.B"}) {
      stein_frame_set_plane(frame_, name, STEIN_FLOAT32, memory_.data(), 0, 0);
    }
    stein_frame_set_sample_count(frame_, 4);
  }

  /// A layer, whole: one that is declared without planes is refused.
  void set_layer() {
    for (const char* name : {"light", "light.R", "light.G", "light.B"}) {
      stein_frame_set_plane(frame_, name, STEIN_FLOAT32, memory_.data(), 0, 0);
    }
  }

  void copy_frame() {
    const std::string name = values_.text();
    const ptrdiff_t pixel = small_stride(values_.take<std::uint8_t>());
    const ptrdiff_t row = small_stride(values_.take<std::uint8_t>());
    if (is_safe_) stein_frame_copy(frame_, name.c_str(), copy_.data(), pixel, row);
  }

  void set_counts() {
    stein_frame_set_sample_count(frame_, values_.take<float>());
    stein_frame_set_degrees_of_freedom(frame_, values_.take<float>());
  }

  void make_params() {
    stein_params_destroy(params_);
    denoisers_ = 0;
    const std::string name = values_.text();
    stein_params_create(name.empty() ? nullptr : name.c_str(), &params_);
  }

  void set_text() {
    const std::string name = values_.text();
    stein_params_set_text(params_, name.c_str(), values_.text().c_str());
  }

  void set_number() {
    const auto number = values_.take<float>();
    stein_params_set_number(params_, values_.text().c_str(), number);
  }

  void add_denoiser() {
    if (denoisers_ == kinds_.size()) return;  // each is run for several draws
    std::uint8_t& kind = kinds_[denoisers_];
    kind = values_.take<std::uint8_t>();
    const auto draws = values_.take<int8_t>();
    const auto step = values_.take<float>();
    const auto seed = values_.take<uint64_t>();
    const std::string name = values_.text();
    if (stein_params_add_denoiser(params_, name.c_str(), kind == 255 ? nullptr : any_denoiser, &kind, draws, step,
                                  seed) == STEIN_OK)
      ++denoisers_;
  }

  void denoise() {
    if (!is_safe_ || result_ != nullptr) return;  // once: it takes most of the time
    // What makes a run long, not wrong. Options that the filter does not have are refused, as they should be.
    if (params_ == nullptr) stein_params_create(nullptr, &params_);
    stein_params_set_text(params_, "spatial-sigmas", "0.5");
    for (const char* name : {"window-radius", "levels"}) stein_params_set_number(params_, name, 1);
    for (const char* name : {"threads", "draws"}) stein_params_set_number(params_, name, 1);
    for (const char* name : {"tile-width", "tile-height"}) stein_params_set_number(params_, name, 16);
    const auto calls = values_.take<std::uint8_t>();
    int left = calls;
    const auto progress = [](double, void* user) { return --*static_cast<int*>(user) > 0 ? 1 : 0; };
    stein_denoise(frame_, params_, calls % 2 == 0 ? nullptr : static_cast<stein_progress>(progress), &left, &result_);
  }

  void look_at_result() {
    const std::string name = values_.text();
    const float* data = nullptr;
    ptrdiff_t row = 0;
    double number = 0;
    const char* text = nullptr;
    stein_result_plane(result_, name.c_str(), &data, &row);
    stein_result_number(result_, name.c_str(), &number);
    stein_result_text(result_, name.c_str(), values_.take<int32_t>(), &text);
    const ptrdiff_t pixel = small_stride(values_.take<std::uint8_t>());
    stein_result_copy(result_, name.c_str(), copy_.data(), pixel, small_stride(values_.take<std::uint8_t>()));
  }

  void make_film() {
    stein_film*& film = films_[values_.take<std::uint8_t>() % films_.size()];
    stein_film_destroy(film);
    const int32_t width = side(values_);
    const int32_t height = side(values_);
    const std::array<int32_t, 2> channels = {values_.take<int8_t>(), values_.take<int8_t>()};
    const std::array<std::string, 2> names = {values_.text(), values_.text()};
    const std::array<const char*, 2> pointers = {names[0].c_str(), names[1].empty() ? nullptr : names[1].c_str()};
    stein_film_create(width, height, pointers.data(), channels.data(), values_.take<std::uint8_t>() % 4 - 1, &film);
  }

  void use_film() {
    std::array<float, 3 + 2 * 4> sample{};
    for (float& value : sample) value = values_.take<float>();
    stein_film_add(films_[0], values_.take<int8_t>(), values_.take<int8_t>(), sample.data());
    stein_film_merge(films_[0], films_[values_.take<std::uint8_t>() % films_.size()]);
    double number = 0;
    stein_film_number(films_[0], values_.text().c_str(), &number);
  }

  void take_film() {
    stein_frame_destroy(frame_);
    is_safe_ = true;
    stein_film_frame(films_[0], &frame_);
  }

  // New ones at the end: the corpus has their numbers.
  static constexpr std::array<Call, 17> kCalls = {
      &Caller::make_frame,  &Caller::add_feature, &Caller::set_plane,  &Caller::set_colour, &Caller::set_counts,
      &Caller::make_params, &Caller::set_text,    &Caller::set_number, &Caller::denoise,    &Caller::look_at_result,
      &Caller::make_film,   &Caller::use_film,    &Caller::take_film,  &Caller::add_layer,  &Caller::set_layer,
      &Caller::copy_frame,  &Caller::add_denoiser};

  stein::fuzz::Values values_;
  std::array<float, kMemory> memory_{};
  std::array<float, kMemory> copy_{};
  stein_frame* frame_ = nullptr;
  stein_params* params_ = nullptr;
  stein_result* result_ = nullptr;
  std::array<std::uint8_t, 3> kinds_{};  // of the denoisers of params_
  std::size_t denoisers_ = 0;
  std::array<stein_film*, 2> films_{};
  bool is_safe_ = true;
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  Caller({bytes, size}).run();
  return 0;
}
