// SPDX-License-Identifier: Apache-2.0
#include "kernels/sample_counts.hpp"

// The instruction that counts bits comes with a set that the other kernels have no use for.
#undef HWY_DISABLED_TARGETS
#define HWY_WANT_AVX3_DL
#define HWY_DISABLED_TARGETS HWY_SSSE3
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/sample_counts.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using WordTag = hn::CappedTag<std::uint32_t, 16>;
using WordVec = hn::Vec<WordTag>;

void CodeRowsTarget(const std::uint8_t* codes, int first_row, int bins, const CodeBits& bits) {
  const hn::CappedTag<std::uint8_t, 64> d8;
  constexpr int kWordSamples = 32;
  const auto lanes = static_cast<int>(hn::Lanes(d8));
  const int step = lanes < kWordSamples ? kWordSamples : lanes;
  for (int bin = 0; bin < bins; ++bin) {
    const auto code = hn::Set(d8, static_cast<std::uint8_t>(bin));
    std::uint32_t* row = bits.words + first_row + bin;
    for (int i = 0; i < kWordSamples * bits.word_count; i += step) {
      std::uint8_t packed[16] = {};
      if (lanes >= 8) {
        for (int k = 0; k < step; k += lanes) {
          hn::StoreMaskBits(d8, hn::Eq(hn::LoadU(d8, codes + i + k), code), packed + k / 8);
        }
      } else {
        for (int k = 0; k < step; ++k) packed[k / 8] |= static_cast<std::uint8_t>((codes[i + k] == bin) << (k % 8));
      }
      for (int w = 0; w < step / kWordSamples; ++w) {
        const std::uint8_t* b = packed + static_cast<std::ptrdiff_t>(4) * w;
        row[(i / kWordSamples + w) * bits.pitch] = b[0] | static_cast<std::uint32_t>(b[1]) << 8U |
                                                   static_cast<std::uint32_t>(b[2]) << 16U |
                                                   static_cast<std::uint32_t>(b[3]) << 24U;
      }
    }
  }
}

// Bits that row x shares with the rows from y on.
HWY_INLINE WordVec shared_bits(WordTag d, const CodeBits& bits, int x, int y) {
  WordVec count = hn::Zero(d);
  const std::uint32_t* word = bits.words;
  for (int w = 0; w < bits.word_count; ++w, word += bits.pitch) {
    count = hn::Add(count, hn::PopulationCount(hn::And(hn::Set(d, word[x]), hn::LoadU(d, word + y))));
  }
  return count;
}

void JointTarget(const CodeBits& bits, const std::int32_t* counts, const float* entropy, int first_x, int end_x,
                 int first_y, int end_y, float* sums) {
  const WordTag d;
  const hn::RebindToSigned<WordTag> di;
  const hn::RebindToFloat<WordTag> df;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int y = first_y; y < end_y; y += lanes) {
    auto sum = hn::Zero(df);
    for (int x = first_x; x < end_x; ++x) {
      if (counts[x] == 0) continue;  // outliers leave many bins empty
      sum = hn::Add(sum, hn::GatherIndex(df, entropy, hn::BitCast(di, shared_bits(d, bits, x, y))));
    }
    hn::StoreU(sum, df, sums + (y - first_y));
  }
}

void RowCountsTarget(const CodeBits& bits, int rows, std::int32_t* counts) {
  const WordTag d;
  const hn::RebindToSigned<WordTag> di;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int r = 0; r < rows; r += lanes) {
    WordVec count = hn::Zero(d);
    for (int w = 0; w < bits.word_count; ++w) {
      count = hn::Add(count, hn::PopulationCount(hn::LoadU(d, bits.words + w * bits.pitch + r)));
    }
    hn::StoreU(hn::BitCast(di, count), di, counts + r);
  }
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stein::kernels {

HWY_EXPORT(CodeRowsTarget);
HWY_EXPORT(JointTarget);
HWY_EXPORT(RowCountsTarget);

void code_rows(const std::uint8_t* codes, int first_row, int bins, const CodeBits& bits) {
  HWY_DYNAMIC_DISPATCH(CodeRowsTarget)(codes, first_row, bins, bits);
}

void joint_entropy_sums(const CodeBits& bits, const std::int32_t* counts, const float* entropy, int first_x, int end_x,
                        int first_y, int end_y, float* sums) {
  HWY_DYNAMIC_DISPATCH(JointTarget)(bits, counts, entropy, first_x, end_x, first_y, end_y, sums);
}

void row_counts(const CodeBits& bits, int rows, std::int32_t* counts) {
  HWY_DYNAMIC_DISPATCH(RowCountsTarget)(bits, rows, counts);
}

}  // namespace stein::kernels
#endif  // HWY_ONCE
