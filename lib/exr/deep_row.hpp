// SPDX-License-Identifier: Apache-2.0
//
// Decodes the chunks of deep scanlines. OpenEXR's own decoder is not used: it wants a pointer per pixel and channel,
// which a small file can claim gigabytes of, and does not notice a chunk that decodes to less than it should.
#pragma once

#include <ImfHeader.h>
#include <ImfPixelType.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace stein::exr {

class DeepRow {
 public:
  /// A chunk begins with its row and three sizes, as DeepScanLineInputPart::rawPixelData delivers it.
  static constexpr std::size_t kHeaderBytes = 28;

  explicit DeepRow(const Imf::Header& header);

  /// Decodes a chunk of `size` bytes, at least kHeaderBytes: counts first, then, once these are known to fit, the
  /// samples. Throws std::runtime_error with the reason, before it asks for memory that the chunk cannot fill.
  void decode(const char* chunk, std::size_t size);

  [[nodiscard]] const std::vector<std::uint32_t>& counts() const noexcept { return counts_; }
  [[nodiscard]] std::size_t samples() const noexcept { return samples_; }  ///< of all pixels

  /// Stores one channel of all samples as floats at to[0], to[stride], ...
  void read(std::size_t channel, float* to, std::size_t stride) const;

  /// In the order of the header.
  [[nodiscard]] const std::vector<std::string>& channels() const noexcept { return names_; }

 private:
  struct Block;

  void decode_counts(const Block& block);
  void decode_samples(const Block& block);
  const char* unpack(const Block& block, std::size_t bytes, const char* what);

  std::size_t width_;
  Imf::Compression compression_;
  std::vector<std::string> names_;
  std::vector<Imf::PixelType> types_;
  std::vector<std::size_t> offsets_;  // of a channel, in bytes of one sample
  std::size_t sample_bytes_ = 0;

  std::vector<std::uint32_t> counts_;
  std::size_t samples_ = 0;
  const char* data_ = nullptr;  // decoded: in `unpacked_`, or in the chunk if it is not compressed
  std::vector<char> packed_;    // before its bytes are put in order
  std::vector<char> unpacked_;
};

}  // namespace stein::exr
