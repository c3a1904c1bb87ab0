// SPDX-License-Identifier: Apache-2.0
//
// The kernels against plain loops in double, for sizes around those of vectors and blocks.
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "catch.hpp"
#include "exec/buffers.hpp"
#include "kernels/sample_counts.hpp"
#include "kernels/sample_weights.hpp"
#include "support/synthetic.hpp"

namespace {

namespace kernels = stein::kernels;
using stein::exec::FloatBuffer;
using stein::test::Random;

struct Records {
  int stride = 0;
  std::vector<float> values;
  std::vector<const float*> pointers;
};

Records make_records(int count, int stride) {
  constexpr int kReadable = 16;
  Records records{stride, {}, {}};
  Random random(static_cast<std::uint64_t>(count) + 1);
  for (int i = 0; i < count * stride + kReadable; ++i) records.values.push_back(static_cast<float>(random.uniform()));
  for (int i = 0; i < count; ++i) records.pointers.push_back(records.values.data() + (i * 7 % count) * stride);
  return records;
}

template <class Body>
void on_every_instruction_set(Body body) {
  for (std::int64_t targets = hwy::SupportedTargets(); targets != 0; targets &= targets - 1) {
    INFO(hwy::TargetName(targets & -targets));
    hwy::SetSupportedTargetsForTest(targets & -targets);
    body();
  }
  hwy::SetSupportedTargetsForTest(0);
}

constexpr int kBlock = kernels::kSampleBlock;
std::ptrdiff_t padded(int count) { return (count + kBlock - 1) / kBlock * kBlock; }

}  // namespace

TEST_CASE("samples are kept if all their features are within bounds, in order") {
  on_every_instruction_set([] {
    for (const int count : {1, 5, 16, 37}) {
      for (const int features : {1, 7, 16, 19}) {
        const Records records = make_records(count, 20);
        const auto bounds = static_cast<std::size_t>((features + 15) / 16 * 16);
        std::vector<float> low(bounds, -INFINITY);
        std::vector<float> high(bounds, INFINITY);
        for (int k = 0; k < features; ++k) low[static_cast<std::size_t>(k)] = 0.1F;
        high[static_cast<std::size_t>(features) - 1] = 0.9F;
        std::vector<std::int32_t> expected;
        for (int i = 0; i < count; ++i) {
          const float* record = records.pointers[static_cast<std::size_t>(i)];
          const bool is_in = std::all_of(record, record + features, [](float v) { return v >= 0.1F; });
          if (is_in && record[features - 1] <= 0.9F) expected.push_back(i);
        }
        std::vector<std::int32_t> kept(static_cast<std::size_t>(count) + 1);
        const int found = kernels::keep_similar_samples(records.pointers.data(), count, low.data(), high.data(),
                                                        static_cast<int>(bounds), kept.data());
        kept.resize(static_cast<std::size_t>(found));
        INFO(count << " samples, " << features << " features");
        CHECK(kept == expected);
      }
    }
  });
}

TEST_CASE("records become planes, padded with the first") {
  on_every_instruction_set([] {
    for (const int count : {1, 4, 63, 64, 65, 130}) {
      const Records records = make_records(count, 12);
      std::vector<std::int32_t> kept;
      for (int i = count - 1; i >= 0; --i) kept.push_back(i);
      const std::ptrdiff_t pitch = padded(count);
      FloatBuffer planes;
      planes.reserve(static_cast<std::size_t>(12 * pitch));
      kernels::gather_samples(records.pointers.data(), kept.data(), count, 12, planes.data(), pitch);
      int wrong = 0;
      for (int k = 0; k < 12; ++k) {
        for (std::ptrdiff_t i = 0; i < pitch; ++i) {
          const auto from = static_cast<std::size_t>(i < count ? count - 1 - i : count - 1);
          wrong += planes.data()[k * pitch + i] == records.pointers[from][k] ? 0 : 1;
        }
      }
      INFO(count << " samples");
      CHECK(wrong == 0);
    }
  });
}

TEST_CASE("weighted means of samples agree with plain loops") {
  on_every_instruction_set([] {
    for (const int count : {1, 3, 16, 40, 64, 100}) {
      for (const int own : {1, 2, 4, 5, 8, 9}) {
        if (own > count) continue;
        const std::ptrdiff_t pitch = padded(count);
        FloatBuffer buffer;
        buffer.reserve(static_cast<std::size_t>(6 * pitch));
        Random random(17);
        for (std::ptrdiff_t i = 0; i < 6 * pitch; ++i) buffer.data()[i] = static_cast<float>(3 * random.normal());
        const auto plane = [&](int k) { return buffer.data() + k * pitch; };
        const float* scaled[] = {plane(0), plane(1), plane(2)};
        std::vector<float> result(static_cast<std::size_t>(3 * own));
        kernels::weighted_samples({scaled, 3, {plane(3), plane(4), plane(5)}, count, own}, result.data());
        double worst = 0;
        for (int i = 0; i < own; ++i) {
          for (int c = 0; c < 3; ++c) {
            double sum = 0;
            double weights = 0;
            for (int j = 0; j < count; ++j) {
              double distance = 0;
              for (int k = 0; k < 3; ++k) distance += std::pow(double{plane(k)[i]} - double{plane(k)[j]}, 2);
              weights += std::exp2(-distance);
              sum += std::exp2(-distance) * plane(3 + c)[j];
            }
            worst = std::max(worst, std::abs(result[static_cast<std::size_t>(3 * i + c)] - sum / weights));
          }
        }
        INFO(count << " samples, " << own << " own");
        CHECK(worst < 1e-5);
      }
    }
  });
}

TEST_CASE("without planes to differ in, all samples count alike") {
  FloatBuffer colour;
  colour.reserve(64);
  for (int i = 0; i < 64; ++i) colour.data()[i] = static_cast<float>(i);
  std::vector<float> result(6);
  kernels::weighted_samples({nullptr, 0, {colour.data(), colour.data(), colour.data()}, 10, 2}, result.data());
  CHECK(result == std::vector<float>(6, 4.5F));
}

TEST_CASE("bins, their rows of bits and what two rows share") {
  on_every_instruction_set([] {
    for (const int count : {1, 31, 33, 64, 100, 200}) {
      const std::ptrdiff_t size = padded(count);
      FloatBuffer planes;
      planes.reserve(static_cast<std::size_t>(2 * size));
      Random random(static_cast<std::uint64_t>(count));
      for (std::ptrdiff_t i = 0; i < 2 * size; ++i) planes.data()[i] = static_cast<float>(random.normal());
      planes.data()[0] = 1e6F;  // beyond the last bin that is told apart
      std::vector<std::uint8_t> codes(static_cast<std::size_t>(2 * size));
      int rows[3] = {};
      for (int k = 0; k < 2; ++k) {
        const float* plane = planes.data() + k * size;
        rows[k + 1] = rows[k] + kernels::sample_codes(plane, kernels::sample_moments(plane, count), count,
                                                      codes.data() + k * size);
      }
      std::vector<std::uint32_t> words(static_cast<std::size_t>(size) / 32 * 96, 0xFFFFFFFFU);
      const kernels::CodeBits bits{words.data(), 96, static_cast<int>(size) / 32};
      for (int k = 0; k < 2; ++k) kernels::code_rows(codes.data() + k * size, rows[k], rows[k + 1] - rows[k], bits);
      std::vector<float> value(static_cast<std::size_t>(count) + 1);
      for (std::size_t n = 0; n < value.size(); ++n) value[n] = static_cast<float>(n * n);
      std::vector<float> sums(96);
      std::vector<std::int32_t> counts(128);
      kernels::row_counts(bits, rows[2], counts.data());
      kernels::joint_entropy_sums(bits, counts.data(), value.data(), rows[0], rows[1], rows[1], rows[2], sums.data());
      for (int y = 0; y < rows[2] - rows[1]; ++y) {
        float expected = 0;
        for (int x = 0; x < rows[1]; ++x) {
          int shared = 0;
          for (int i = 0; i < count; ++i)
            shared += codes[static_cast<std::size_t>(i)] == x && codes[static_cast<std::size_t>(size + i)] == y;
          expected += value[static_cast<std::size_t>(shared)];
        }
        CHECK(sums[static_cast<std::size_t>(y)] == expected);
      }
      int total = 0;
      for (int r = 0; r < rows[2]; ++r) total += counts[static_cast<std::size_t>(r)];
      CHECK(total == 2 * count);  // every sample is in one bin of each column
    }
  });
}
