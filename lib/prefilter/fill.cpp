// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/large_array.hpp"
#include "prefilter/source.hpp"
#include "stein/error.hpp"

namespace stein {
namespace {

// Progress of the fill: which pixels are known, and the values of those that had to be filled.
class Holes {
 public:
  // Of up to three planes of the frame. validity_row(y, mask) fills a row's mask and returns the number of zeros.
  template <class ValidityRow>
  Holes(const Frame& frame, const ConstPlaneView* planes, std::size_t channels, Memory* memory,
        ValidityRow validity_row)
      : frame_(frame),
        planes_(planes),
        channels_(channels),
        memory_(memory),
        entry_(static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height), memory) {
    std::vector<float> mask(static_cast<std::size_t>(frame.width));
    for (int y = 0; y < frame.height; ++y) {
      trim();
      if (validity_row(y, mask.data()) == 0) continue;
      for (int x = 0; x < frame.width; ++x) {
        if (mask[static_cast<std::size_t>(x)] == 0.0F) at(x, y) = kUnknown;
      }
    }
  }

  [[nodiscard]] bool is_unknown(int x, int y) const { return entry_[index(x, y)] == kUnknown; }
  [[nodiscard]] bool is_known(int x, int y) const {
    return entry_[index(x, y)] != kUnknown && entry_[index(x, y)] != kQueued;
  }

  // The unknown pixels next to known ones, in row order; marks them as queued.
  std::vector<ReplacedPixel> first_layer() {
    std::vector<ReplacedPixel> layer;
    for (int y = 0; y < frame_.height; ++y) {
      trim();
      for (int x = 0; x < frame_.width; ++x) {
        if (is_unknown(x, y) && mean_of_known(x, y, nullptr) > 0) layer.push_back({x, y, {}});
      }
    }
    for (const ReplacedPixel& p : layer) at(p.x, p.y) = kQueued;
    return layer;
  }

  // Gives a layer its values, makes it known, and returns the unknown pixels next to it.
  std::vector<ReplacedPixel> advance(std::vector<ReplacedPixel>& layer) {
    for (ReplacedPixel& p : layer) mean_of_known(p.x, p.y, &p.colour);
    std::vector<ReplacedPixel> next;
    for (const ReplacedPixel& p : layer) {
      if (filled_.size() % 256 == 0) trim();
      at(p.x, p.y) = kFirst + static_cast<std::uint32_t>(filled_.size());
      filled_.push_back(p);
      for_each_neighbour(p.x, p.y, [&](int x, int y) {
        if (!is_unknown(x, y)) return;
        at(x, y) = kQueued;
        next.push_back({x, y, {}});
      });
    }
    return next;
  }

  std::vector<ReplacedPixel> take_filled() { return std::move(filled_); }

 private:
  enum : std::uint32_t { kValid, kUnknown, kQueued, kFirst };

  void trim() const {
    if (memory_ != nullptr) memory_->trim();
  }

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(frame_.width) + static_cast<std::size_t>(x);
  }
  std::uint32_t& at(int x, int y) { return entry_[index(x, y)]; }

  template <class Visit>
  void for_each_neighbour(int x, int y, Visit visit) const {
    for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, frame_.height - 1); ++ny) {
      for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, frame_.width - 1); ++nx) {
        if (nx != x || ny != y) visit(nx, ny);
      }
    }
  }

  int mean_of_known(int x, int y, std::array<float, 3>* mean) const {
    std::array<double, 3> sum{};
    int count = 0;
    for_each_neighbour(x, y, [&](int nx, int ny) {
      if (!is_known(nx, ny)) return;
      ++count;
      const std::uint32_t entry = entry_[index(nx, ny)];
      for (std::size_t c = 0; c < channels_ && mean != nullptr; ++c) {
        sum[c] += entry == kValid ? planes_[c].at(nx, ny) : filled_[entry - kFirst].colour[c];
      }
    });
    for (std::size_t c = 0; c < channels_ && mean != nullptr; ++c) (*mean)[c] = static_cast<float>(sum[c] / count);
    return count;
  }

  const Frame& frame_;
  const ConstPlaneView* planes_;
  std::size_t channels_;
  Memory* memory_;
  LargeArray<std::uint32_t> entry_;  // kValid, kUnknown, kQueued, or kFirst plus the index into filled_
  std::vector<ReplacedPixel> filled_;
};

// refuse() throws, where no pixel is known.
template <class Refuse>
std::vector<ReplacedPixel> fill(Holes holes, const Refuse& refuse) {
  std::vector<ReplacedPixel> layer = holes.first_layer();
  while (!layer.empty()) layer = holes.advance(layer);
  std::vector<ReplacedPixel> filled = holes.take_filled();
  if (filled.empty()) refuse();
  std::sort(filled.begin(), filled.end(),
            [](const ReplacedPixel& a, const ReplacedPixel& b) { return std::pair(a.y, a.x) < std::pair(b.y, b.x); });
  return filled;
}

}  // namespace

std::vector<ReplacedPixel> fill_invalid(const Frame& frame, Memory* memory) {
  Holes holes(frame, frame.colour.data(), frame.colour.size(), memory,
              [&](int y, float* mask) { return colour_validity_row(frame, y, 0, frame.width, mask); });
  return fill(std::move(holes), [&frame] {
    throw Error(ErrorCode::kInvalidFrame, name_of(frame) + ": " + describe(inspect(frame).first_invalid) +
                                              ", and no pixel has usable colour, variance and samples: nothing can be "
                                              "filtered; render the frame again");
  });
}

std::vector<ReplacedPixel> fill_layer(const Frame& frame, const Layer& layer, Memory* memory) {
  Holes holes(frame, layer.mean.data(), layer.mean.size(), memory,
              [&](int y, float* mask) { return layer_validity_row(frame, layer, y, 0, frame.width, mask); });
  return fill(std::move(holes), [&] {
    throw Error(ErrorCode::kInvalidFrame, name_of(frame) + ": no pixel has a usable value in layer '" + layer.name +
                                              "': nothing can be filtered; leave the layer out, or render it again");
  });
}

}  // namespace stein
