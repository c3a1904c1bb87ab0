// SPDX-License-Identifier: Apache-2.0
#include "renderer.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <numeric>

#include "parallel.hpp"
#include "stein/error.hpp"

namespace pathtracer {
namespace {

constexpr int kChunk = 16;  // pixels of a row that one thread takes at a time
constexpr std::size_t kSampleFloats = sizeof(PathSample) / sizeof(float);
static_assert(kSampleFloats == 27, "one name in sample_channels() for each float of PathSample");

[[noreturn]] void fail(const std::string& message) { throw stein::Error(stein::ErrorCode::kInvalidArgument, message); }

std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

}  // namespace

const std::vector<std::string>& sample_channels() {
  static const std::vector<std::string> channels = {"R",
                                                    "G",
                                                    "B",
                                                    "albedo.R",
                                                    "albedo.G",
                                                    "albedo.B",
                                                    "normal.X",
                                                    "normal.Y",
                                                    "normal.Z",
                                                    "depth.Z",
                                                    "position.X",
                                                    "position.Y",
                                                    "position.Z",
                                                    "visibility.V",
                                                    "random.pixel.X",
                                                    "random.pixel.Y",
                                                    "random.lens.X",
                                                    "random.lens.Y",
                                                    "random.time.T",
                                                    "random.light.X",
                                                    "random.light.Y",
                                                    "position2.X",
                                                    "position2.Y",
                                                    "position2.Z",
                                                    "normal2.X",
                                                    "normal2.Y",
                                                    "normal2.Z"};
  return channels;
}

std::vector<stein::FeatureLayout> feature_layout() {
  return {{"albedo", 3}, {"normal", 3}, {"depth", 1}, {"position", 3}, {"visibility", 1}};
}

// One call of `render`: what is to be done, and for whom.
class Renderer::Round {
 public:
  Round(Renderer& renderer, const std::uint32_t* counts, stein::Accumulator& film, const stein::Execution& execution)
      : renderer_(renderer),
        counts_(counts),
        film_(film),
        parallel_(execution, std::accumulate(counts, counts + renderer.taken_.size(), 0.0)),
        chunks_((renderer.width_ + kChunk - 1) / kChunk) {}

  void render_rows(int first, int count) {
    parallel_.for_each(count * chunks_, [&](int item) {
      const int y = first + item / chunks_;
      const int x = item % chunks_ * kChunk;
      double samples = 0;
      for (int i = x; i < std::min(x + kChunk, renderer_.width_); ++i) samples += render_pixel(i, y, nullptr);
      return samples;
    });
  }

  void render_row(int y, const RowSink& sink) {
    const std::uint32_t* counts = counts_ + pixel(0, y);
    starts_.assign(1, 0);
    for (int x = 0; x < renderer_.width_; ++x) starts_.push_back(starts_.back() + counts[x] * kSampleFloats);
    samples_.resize(starts_.back());
    parallel_.for_each(renderer_.width_, [&](int x) {
      return render_pixel(x, y, samples_.data() + starts_[static_cast<std::size_t>(x)]);
    });
    sink(counts, samples_.data());
  }

 private:
  [[nodiscard]] std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(renderer_.width_) + static_cast<std::size_t>(x);
  }

  // Returns how many samples it took.
  double render_pixel(int x, int y, float* raw) {
    const std::uint32_t count = counts_[pixel(x, y)];
    std::uint32_t& taken = renderer_.taken_[pixel(x, y)];
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto sample = std::bit_cast<std::array<float, kSampleFloats>>(renderer_.sample(x, y, taken++));
      film_.add(x, y, sample.data());
      if (raw != nullptr) std::copy(sample.begin(), sample.end(), raw + i * kSampleFloats);
    }
    return count;
  }

  Renderer& renderer_;
  const std::uint32_t* counts_;
  stein::Accumulator& film_;
  Parallel parallel_;
  int chunks_;                       // per row
  std::vector<std::size_t> starts_;  // of the pixels in samples_
  std::vector<float> samples_;       // of one row
};

Renderer::Renderer(const Scene& scene, int width, int height, std::uint64_t seed, const PathSettings& settings)
    : scene_(scene), settings_(settings), seed_(seed), width_(width), height_(height) {
  constexpr int kMaxSide = 1 << 16;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    fail("the image is " + size_text(width, height) + "; each side must be 1 to " + std::to_string(kMaxSide));
  }
  taken_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
}

PathSample Renderer::sample(int x, int y, std::uint32_t index) const {
  const std::uint64_t pixel = static_cast<std::uint64_t>(y) << 32U | static_cast<std::uint64_t>(x);
  Random random(seed_, pixel, index);
  CameraSample camera;
  camera.pixel = random.uniform2();
  camera.lens = random.uniform2();
  camera.time = random.uniform();
  PathSample sample = trace_path(scene_, scene_.camera().ray(x, y, width_, height_, camera), random, settings_);
  sample.camera = camera;
  return sample;
}

void Renderer::check(const stein::Accumulator& film) const {
  if (film.width() != width_ || film.height() != height_) {
    fail("the film is " + size_text(film.width(), film.height()) + ", the image " + size_text(width_, height_));
  }
  if (!film.layout().features.empty() && film.layout().features != feature_layout()) {
    fail("the film's features are not those of feature_layout()");
  }
}

void Renderer::render(const std::uint32_t* counts, stein::Accumulator& film, const stein::Execution& execution) {
  check(film);
  Round(*this, counts, film, execution).render_rows(0, height_);
}

void Renderer::render(const std::uint32_t* counts, stein::Accumulator& film, const stein::Execution& execution,
                      const RowSink& sink) {
  check(film);
  Round round(*this, counts, film, execution);
  for (int y = 0; y < height_; ++y) round.render_row(y, sink);
}

}  // namespace pathtracer
