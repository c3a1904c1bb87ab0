// SPDX-License-Identifier: Apache-2.0
#include "pipeline/blend.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/relative_risk.hpp"
#include "select/selection.hpp"

namespace stein {
namespace {

constexpr int kBlock = 16;           // px
constexpr double kSigma = 2.0;       // blocks: how far around a block the risks count
constexpr int kReach = 5;            // blocks
constexpr double kImageShare = 0.3;  // of the image's mean risk, next to the mean around the block
// A pixel whose relative risk is above this counts as much less: few pixels with wrong variances must not decide.
constexpr float kLimit = 0.1F;
constexpr float kNoiseLimit = 0.1F;  // the same for its noise, where pictures that are no filter's are compared

// The residuals, divergences and weights of one row of a block, all channels one after the other.
struct BlockRow {
  int count = 0;  // pixels
  float* residual[kMaxMixed];
  float* divergence[kMaxMixed];
  float* weight = nullptr;
  float* variance = nullptr;
};

constexpr int kValues = 3 * kBlock;  // of a row
constexpr int kBlockLines = 2 * kMaxMixed + 2;

// Relative risk of a picture at a pixel of the row.
float risk_at(const BlockRow& row, int picture, int x) {
  float risk = 0;
  for (int i = x; i < kValues; i += kBlock) {
    const float r = row.residual[picture][i];
    risk += row.weight[i] * (r * r + 2.0F * row.divergence[picture][i] - row.variance[i]);
  }
  return risk;
}

// What a pixel counts by the risks of the filters' pictures.
float share_by_risk(const BlockRow& row, int own, int x) {
  float largest = kLimit;
  for (int k = 1; k < own; ++k) largest = std::max(largest, std::abs(risk_at(row, k, x)));
  return kLimit / largest;
}

// The same by how far its noise moves the comparison of a picture with the mean of the filters', G: by
// 2 (F - G) (G - y). What all pictures have in common cancels, and a picture that is far from the others counts.
float share_by_noise(const BlockRow& row, int own, int pictures, std::uint32_t compared, int x) {
  float common[3] = {};  // G - y
  for (std::size_t c = 0; c < 3; ++c) {
    for (int k = 1; k < own; ++k) common[c] += row.residual[k][static_cast<int>(c) * kBlock + x];
    common[c] /= static_cast<float>(own - 1);
  }
  float largest = kNoiseLimit;
  for (int k = 1; k < pictures; ++k) {
    if (((compared >> static_cast<unsigned>(k)) & 1U) == 0) continue;
    float noise = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const int i = static_cast<int>(c) * kBlock + x;
      noise += row.weight[i] * std::abs((row.residual[k][i] - common[c]) * common[c]);
    }
    largest = std::max(largest, noise);
  }
  return kNoiseLimit / largest;
}

template <class Share>
void add_row(const BlockRow& row, int pictures, const float* mask, const Share& share_of, MixtureRisk& sums) {
  for (int x = 0; x < row.count; ++x) {
    if (mask[x] == 0.0F) continue;
    const float share = share_of(x);
    sums.pixels += 1.0;
    for (int i = x; i < kValues; i += kBlock) {
      const double weight = share * row.weight[i];
      sums.noise += weight * row.variance[i];
      for (int k = 0; k < pictures; ++k) {
        sums.divergences[static_cast<std::size_t>(k)] += weight * row.divergence[k][i];
        for (int l = 0; l <= k; ++l) {
          sums.products[MixtureRisk::pair(k, l)] +=
              weight * static_cast<double>(row.residual[k][i]) * static_cast<double>(row.residual[l][i]);
        }
      }
    }
  }
}

// Gaussian sums along one axis of the grid: `stride` from block to block, `length` of them.
void blur_line(const MixtureRisk* in, std::ptrdiff_t stride, int length, MixtureRisk* out) {
  for (int i = 0; i < length; ++i) {
    MixtureRisk sum;
    for (int j = std::max(i - kReach, 0); j <= std::min(i + kReach, length - 1); ++j) {
      sum.add(in[j * stride], std::exp(-0.5 * (j - i) * (j - i) / (kSigma * kSigma)));
    }
    out[i * stride] = sum;
  }
}

void blur(int columns, int rows, exec::Runner& runner, Memory* memory, LargeArray<MixtureRisk>& grid) {
  LargeArray<MixtureRisk> other(grid.size(), memory);
  runner.for_each(rows, 0.0, [&](int y, int) {
    blur_line(grid.data() + std::ptrdiff_t{y} * columns, 1, columns, other.data() + std::ptrdiff_t{y} * columns);
  });
  runner.for_each(columns, 0.0, [&](int x, int) { blur_line(other.data() + x, columns, rows, grid.data() + x); });
}

// Squared, of a picture from the mixture of the first `count`.
double distance(const MixtureRisk& risk, const MixtureWeights& weights, int count, int picture) {
  double sum = risk.product(picture, picture);
  for (int k = 0; k < count; ++k) {
    const double weight = weights[static_cast<std::size_t>(k)];
    sum -= 2.0 * weight * risk.product(picture, k);
    for (int l = 0; l < count; ++l) sum += weight * weights[static_cast<std::size_t>(l)] * risk.product(k, l);
  }
  return sum;
}

// Between which centres of blocks a pixel lies, and how far it is from the first.
struct Between {
  int first = 0;
  int second = 0;
  float share = 0;  // of the second
};

Between between(int pixel, int blocks) {
  const float position = (static_cast<float>(pixel) + 0.5F) / kBlock - 0.5F;
  const int first = static_cast<int>(std::floor(position));
  return {std::clamp(first, 0, blocks - 1), std::clamp(first + 1, 0, blocks - 1), position - static_cast<float>(first)};
}

}  // namespace

Blend::Blend(const Source& source, const LayerSource& layers, const std::vector<BlendPicture>& pictures,
             exec::Runner& runner, double progress_weight)
    : source_(source),
      layers_(layers),
      pictures_(pictures),
      count_(1 + static_cast<int>(pictures.size())),
      own_(1 + static_cast<int>(std::count_if(pictures.begin(), pictures.end(),
                                              [](const BlendPicture& picture) { return !picture.is_external; }))),
      columns_((source.frame().width + kBlock - 1) / kBlock),
      rows_((source.frame().height + kBlock - 1) / kBlock) {
  const double part = own_ == count_ ? progress_weight : progress_weight / 2;
  const std::vector<Pictures> none(row_start(rows_), 0);
  const Risks risks = block_risks(none, runner, part);
  weights_.resize(none.size());
  runner.for_each(rows_, 0.0, [&](int row, int) {
    for (std::size_t block = row_start(row); block < row_start(row + 1); ++block)
      weights_[block] = least_risk(risks.of(block, none[block]), own_);
  });
  if (own_ < count_) add_externals(risks, runner, part);
}

// Of a block with its surroundings, and some of the image.
MixtureRisk Blend::Risks::of(std::size_t block, Pictures compared) const {
  const MixtureRisk& image = images.at(compared);
  MixtureRisk risk = blocks[block];
  if (!(risk.pixels > 0)) return image;
  risk.add(image, kImageShare * risk.pixels / image.pixels);
  return risk;
}

// What is farther from the filters' mixture than the noise of the input is worse than the input: it has no say.
Blend::Pictures Blend::plausible(const MixtureRisk& risk, const MixtureWeights& own) const {
  Pictures found = 0;
  for (int k = own_; k < count_; ++k) {
    if (distance(risk, own, own_, k) < risk.noise) found |= Pictures{1} << static_cast<unsigned>(k);
  }
  return found;
}

// Weights anew, where there is an external picture that can be right; the others stay.
void Blend::add_externals(const Risks& own_risks, exec::Runner& runner, double progress_weight) {
  const Pictures own = (Pictures{1} << static_cast<unsigned>(own_)) - 1;
  std::vector<Pictures> compared(weights_.size());
  runner.for_each(rows_, 0.0, [&](int row, int) {
    for (std::size_t block = row_start(row); block < row_start(row + 1); ++block)
      compared[block] = own | plausible(own_risks.blocks[block], weights_[block]);
  });
  const Risks risks = block_risks(compared, runner, progress_weight);
  runner.for_each(rows_, 0.0, [&](int row, int) {
    for (std::size_t block = row_start(row); block < row_start(row + 1); ++block) {
      if (compared[block] == own) continue;
      weights_[block] = least_risk(risks.of(block, compared[block]), count_, compared[block]);
    }
  });
}

// `compared`: of each block, see block_risk.
Blend::Risks Blend::block_risks(const std::vector<Pictures>& compared, exec::Runner& runner,
                                double progress_weight) const {
  Risks risks{LargeArray<MixtureRisk>(compared.size(), source_.memory()), {}};
  std::vector<std::vector<float>> lines(static_cast<std::size_t>(runner.slots()),
                                        std::vector<float>(kBlockLines * kValues));
  runner.for_each(rows_, progress_weight, [&](int row, int slot) {
    for (int column = 0; column < columns_; ++column) {
      const std::size_t block = row_start(row) + static_cast<std::size_t>(column);
      risks.blocks[block] = block_risk(column, row, compared[block], lines[static_cast<std::size_t>(slot)].data());
    }
  });
  for (int row = 0; row < rows_; ++row) {
    if (source_.memory() != nullptr) source_.memory()->trim();
    for (std::size_t block = row_start(row); block < row_start(row + 1); ++block)
      risks.images[compared[block]].add(risks.blocks[block], 1.0);
  }
  blur(columns_, rows_, runner, source_.memory(), risks.blocks);
  return risks;
}

// `compared`: the pictures whose differences limit what a pixel counts; none: the filters' risks limit it.
MixtureRisk Blend::block_risk(int column, int row, Pictures compared, float* lines) const {
  const Frame& frame = source_.frame();
  const int x0 = column * kBlock;
  BlockRow values;
  values.count = std::min(kBlock, frame.width - x0);
  values.weight = lines;
  values.variance = lines + kValues;
  for (int k = 0; k < count_; ++k) {
    values.residual[k] = lines + (2 + 2 * k) * kValues;
    values.divergence[k] = lines + (3 + 2 * k) * kValues;
  }
  float mean[kBlock] = {};
  float mask[kBlock] = {};
  const auto share = [&](int x) {
    return compared == 0 ? share_by_risk(values, own_, x) : share_by_noise(values, own_, count_, compared, x);
  };
  MixtureRisk sums;
  for (int y = row * kBlock; y < std::min((row + 1) * kBlock, frame.height); ++y) {
    for (int c = 0; c < 3; ++c) {
      const auto channel = static_cast<std::size_t>(c);
      const int first = c * kBlock;
      source_.input_row(channel, y, x0, values.count, mean, values.variance + first);
      source_.colour_row(channel, y, x0, values.count, values.residual[0] + first);
      source_.colour_covariance_row(channel, channel, y, x0, values.count, values.divergence[0] + first);
      for (int k = 1; k < count_; ++k) {
        const MixtureRows& picture = pictures_[static_cast<std::size_t>(k - 1)].rows;
        std::copy_n(picture.result(c, y) + x0, values.count, values.residual[k] + first);
        std::copy_n(picture.divergence(c, y) + x0, values.count, values.divergence[k] + first);
        if (compared == 0) continue;
        // The divergence of an external picture is measured, what its making chose included.
        const float* optimism = picture.optimism(y) + x0;
        for (int x = 0; x < values.count; ++x) {
          const float F = values.residual[k][first + x];
          values.divergence[k][first + x] += 0.5F * optimism[x] * (F * F + kRelativeEpsilon);
        }
      }
      for (int x = 0; x < values.count; ++x) {
        float scale = 0;
        for (int k = 1; k < own_; ++k) scale += values.residual[k][first + x];
        scale /= static_cast<float>(own_ - 1);
        values.weight[first + x] = 1.0F / (3.0F * (scale * scale + kRelativeEpsilon));
        for (int k = 0; k < count_; ++k) values.residual[k][first + x] -= mean[x];
      }
    }
    source_.mask_row(y, x0, values.count, mask);
    add_row(values, count_, mask, share, sums);
  }
  return sums;
}

const MixtureWeights& Blend::weights(int column, int row) const noexcept {
  return weights_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
}

MixtureWeights Blend::mean_weights() const {
  std::array<double, kMaxMixed> sums{};
  for (const MixtureWeights& block : weights_) {
    for (std::size_t k = 0; k < block.size(); ++k) sums[k] += block[k];
  }
  MixtureWeights mean{};
  for (std::size_t k = 0; k < mean.size(); ++k)
    mean[k] = static_cast<float>(sums[k] / static_cast<double>(weights_.size()));
  return mean;
}

void Blend::weight_rows(const Rect& tile, int y, float* lines, std::ptrdiff_t pitch) const {
  const Between vertical = between(y, rows_);
  for (int x = tile.x0; x < tile.x1; ++x) {
    const Between horizontal = between(x, columns_);
    const auto mixed = [&](int row, std::size_t k) {
      const float a = weights(horizontal.first, row)[k];
      return a + horizontal.share * (weights(horizontal.second, row)[k] - a);
    };
    for (int k = 0; k < count_; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const float above = mixed(vertical.first, i);
      lines[k * pitch + (x - tile.x0)] = above + vertical.share * (mixed(vertical.second, i) - above);
    }
  }
}

void Blend::run(const Rect& tile, const Mixture& out, float* lines, std::ptrdiff_t pitch) const {
  const int n = tile.width();
  const float* maps[kMaxMixed];
  for (int k = 0; k < count_; ++k) maps[k] = lines + k * pitch;
  for (int y = tile.y0; y < tile.y1; ++y) {
    weight_rows(tile, y, lines, pitch);
    largest_row(maps, count_, n, out.choice->row(y) + tile.x0);
    const auto picture = [&](int k, int plane) {
      return pictures_[static_cast<std::size_t>(k)].rows.plane(plane, y) + tile.x0;
    };
    mix_row(source_, layers_, picture, maps, count_, tile, y, out.rows);
    float* optimism = out.rows.optimism(y) + tile.x0;
    std::fill_n(optimism, n, 0.0F);
    for (int k = 1; k < count_; ++k) {
      const float* own = pictures_[static_cast<std::size_t>(k - 1)].rows.optimism(y) + tile.x0;
      for (int i = 0; i < n; ++i) optimism[i] += maps[k][i] * own[i];
    }
  }
}

}  // namespace stein
