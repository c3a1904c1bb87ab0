// SPDX-License-Identifier: Apache-2.0
#include "exr/deep_row.hpp"

#include <ImfChannelList.h>
#include <half.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "exr/source_file.hpp"

namespace stein::exr {
namespace {

// OpenEXR's codecs count the bytes of a chunk in an int.
constexpr std::size_t kMaxRowBytes = std::numeric_limits<std::int32_t>::max();

[[noreturn]] void fail(const std::string& why) { throw std::runtime_error(why); }

/// Values in files are little-endian.
template <class Bits>
Bits load(const char* from) {
  Bits bits = 0;
  for (std::size_t i = 0; i < sizeof(Bits); ++i) {
    bits = static_cast<Bits>(bits | static_cast<Bits>(static_cast<Bits>(static_cast<unsigned char>(from[i])) << 8 * i));
  }
  return bits;
}

float load_value(const char* from, Imf::PixelType type) {
  if (type == Imf::HALF) {
    half value;
    value.setBits(load<std::uint16_t>(from));
    return value;
  }
  const auto bits = load<std::uint32_t>(from);
  if (type == Imf::UINT) return static_cast<float>(bits);
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/// Runs of equal bytes: a count n >= 0 and a byte that stands n + 1 times, or -n and n bytes as they are.
std::size_t expand_runs(const char* from, std::size_t size, std::vector<char>& to) {
  std::size_t filled = 0;
  for (std::size_t at = 0; at < size;) {
    const int count = static_cast<signed char>(from[at++]);
    const auto length = static_cast<std::size_t>(count < 0 ? -count : count + 1);
    const std::size_t stored = count < 0 ? length : 1;
    if (stored > size - at || length > to.size() - filled) return 0;
    if (count < 0) {
      std::copy_n(from + at, length, to.data() + filled);
    } else {
      std::fill_n(to.data() + filled, length, from[at]);
    }
    at += stored;
    filled += length;
  }
  return filled;
}

std::size_t inflate(const char* from, std::size_t size, std::vector<char>& to) {
  uLongf filled = to.size();
  uLong read = size;
  const int status =
      ::uncompress2(reinterpret_cast<Bytef*>(to.data()), &filled, reinterpret_cast<const Bytef*>(from), &read);
  return status == Z_OK && read == size ? filled : 0;
}

/// Both codecs store the differences of neighbouring bytes, after all bytes of even places were put before all others.
void undo_differences(std::vector<char>& bytes) {
  constexpr int kBias = 128;
  for (std::size_t i = 1; i < bytes.size(); ++i) bytes[i] = static_cast<char>(bytes[i - 1] + bytes[i] - kBias);
}

void interleave_halves(const std::vector<char>& from, std::vector<char>& to) {
  const std::size_t middle = (from.size() + 1) / 2;
  for (std::size_t i = 0; i < from.size(); ++i) to[i] = from[i / 2 + (i % 2 == 0 ? 0 : middle)];
}

}  // namespace

struct DeepRow::Block {
  const char* data;
  std::size_t size;
};

DeepRow::DeepRow(const Imf::Header& header)
    : width_(static_cast<std::size_t>(width_of(header))), compression_(header.compression()) {
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    names_.emplace_back(it.name());
    types_.push_back(it.channel().type);
    offsets_.push_back(sample_bytes_);
    sample_bytes_ += static_cast<std::size_t>(byte_size(scalar_type(it.channel().type)));
  }
}

void DeepRow::decode(const char* chunk, std::size_t size) {
  // OpenEXR has brought these to the machine's byte order.
  std::uint64_t table = 0;
  std::uint64_t packed = 0;
  std::memcpy(&table, chunk + 4, sizeof table);
  std::memcpy(&packed, chunk + 12, sizeof packed);
  const std::size_t rest = size - kHeaderBytes;
  if (table > rest || packed != rest - table)
    fail("the sizes within its chunk contradict each other: the file is damaged");
  decode_counts({chunk + kHeaderBytes, table});
  decode_samples({chunk + kHeaderBytes + table, packed});
}

void DeepRow::decode_counts(const Block& block) {
  const char* table = unpack(block, width_ * sizeof(std::uint32_t), "its table of sample counts");
  counts_.resize(width_);
  std::uint32_t before = 0;  // the table holds running totals
  for (std::size_t x = 0; x < width_; ++x) {
    const auto total = load<std::uint32_t>(table + x * sizeof(std::uint32_t));
    if (total < before || total > kMaxRowBytes) {
      fail("its sample counts decrease or overflow at column " + std::to_string(x) + ": the file is damaged");
    }
    counts_[x] = total - before;
    before = total;
  }
  samples_ = before;
}

void DeepRow::decode_samples(const Block& block) {
  const std::size_t bytes = samples_ * sample_bytes_;
  const std::string claim = "its pixels claim " + std::to_string(samples_) + " samples";
  if (bytes > kMaxRowBytes) fail(claim + ", more than the 2^31 bytes that a row can have: the file is damaged");
  if (bytes / static_cast<std::size_t>(largest_ratio(compression_)) > block.size) {
    fail(claim + ", which cannot come out of its " + std::to_string(block.size) + " bytes: the file is damaged");
  }
  data_ = unpack(block, bytes, "its samples");
}

/// A block that would not get smaller is stored as it is.
const char* DeepRow::unpack(const Block& block, std::size_t bytes, const char* what) {
  if (block.size == bytes) return block.data;
  const auto fail_size = [&] {
    fail(std::string(what) + " do not decode to the " + std::to_string(bytes) +
         " bytes that they should: the file is damaged");
  };
  if (block.size > bytes || compression_ == Imf::NO_COMPRESSION) fail_size();
  packed_.resize(bytes);
  unpacked_.resize(bytes);
  const bool is_runs = compression_ == Imf::RLE_COMPRESSION;
  const std::size_t filled =
      is_runs ? expand_runs(block.data, block.size, packed_) : inflate(block.data, block.size, packed_);
  if (filled != bytes) fail_size();
  undo_differences(packed_);
  interleave_halves(packed_, unpacked_);
  return unpacked_.data();
}

void DeepRow::read(std::size_t channel, float* to, std::size_t stride) const {
  const Imf::PixelType type = types_[channel];
  const auto size = static_cast<std::size_t>(byte_size(scalar_type(type)));
  const char* from = data_ + offsets_[channel] * samples_;
  for (std::size_t i = 0; i < samples_; ++i) to[i * stride] = load_value(from + i * size, type);
}

}  // namespace stein::exr
