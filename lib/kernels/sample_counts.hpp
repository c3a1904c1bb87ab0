// SPDX-License-Identifier: Apache-2.0
//
// Joint histograms of many pairs of vectors of small codes at once: every bin of every vector becomes a row of bits,
// and a cell of a joint histogram is the number of bits that two rows share.
#pragma once

#include <cstddef>
#include <cstdint>

namespace stein::kernels {

/// Bits of all rows: word w of row r is words[w * pitch + r], so that rows are in neighbouring lanes.
struct CodeBits {
  std::uint32_t* words = nullptr;
  std::ptrdiff_t pitch = 0;  ///< a multiple of 16
  int word_count = 0;        ///< of 32 samples each, even
};

/// Rows first_row .. first_row + bins - 1: of the samples whose code is 0, 1, ... `codes`: 32 per word.
void code_rows(const std::uint8_t* codes, int first_row, int bins, const CodeBits& bits);

/// `counts`: of row_counts(). For the rows y in [first_y, end_y): sums[y - first_y] = sum over the rows x in [first_x,
/// end_x) of entropy[number of bits shared by x and y]; entropy[0] is 0. `sums` has room for a multiple of 16.
void joint_entropy_sums(const CodeBits& bits, const std::int32_t* counts, const float* entropy, int first_x, int end_x,
                        int first_y, int end_y, float* sums);

/// counts[r] of the bits of rows 0 .. rows - 1; room for a multiple of 16.
void row_counts(const CodeBits& bits, int rows, std::int32_t* counts);

}  // namespace stein::kernels
