// SPDX-License-Identifier: Apache-2.0
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfPartType.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

#include "exr/replacing_file.hpp"
#include "exr/sample_layers.hpp"
#include "exr/source_file.hpp"
#include "stein/exr_samples.hpp"

namespace stein::exr {
namespace {

constexpr int kMaxSide = 1 << 20;
constexpr std::uint64_t kMaxRowBytes = std::numeric_limits<std::int32_t>::max();

[[noreturn]] void fail(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::kInvalidArgument, "cannot write '" + path + "': " + why);
}

void check(const std::string& path, int width, int height, const std::vector<std::string>& channels,
           const std::array<int, 2>& origin) {
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    fail(path, "a size of " + std::to_string(width) + " x " + std::to_string(height) +
                   " pixels is not possible; each side must be 1 to " + std::to_string(kMaxSide));
  }
  if (std::abs(std::int64_t{origin[0]}) > kMaxSide || std::abs(std::int64_t{origin[1]}) > kMaxSide) {
    fail(path, "the origin must lie within " + std::to_string(kMaxSide) + " pixels of 0");
  }
  check_channel_names("cannot write '" + path + "'", channels);
  for (const char* name : {"R", "G", "B"}) {
    if (std::find(channels.begin(), channels.end(), name) == channels.end()) {
      fail(path, std::string("there is no channel ") + name + "; samples need R, G and B");
    }
  }
}

Imf::Header header_for(int width, int height, const std::vector<std::string>& channels,
                       const SampleWriterOptions& options) {
  const Imath::V2i begin(options.origin[0], options.origin[1]);
  const Imath::Box2i window(begin, begin + Imath::V2i(width - 1, height - 1));
  Imf::Header header(window, window);
  header.compression() = options.compress ? Imf::ZIPS_COMPRESSION : Imf::NO_COMPRESSION;
  header.setType(Imf::DEEPSCANLINE);
  for (const std::string& name : channels) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  return header;
}

}  // namespace

struct SampleWriter::Data {
  Data(const std::string& file_path, Imf::Header file_header, std::vector<std::string> names)
      : path(file_path),
        header(std::move(file_header)),
        channels(std::move(names)),
        counts(static_cast<std::size_t>(width_of(header))),
        samples(counts.size() * channels.size()),
        target(path) {
    output.emplace(target.stream(), &header, 1);
    part.emplace(*output, 0);
    part->setFrameBuffer(frame_buffer());
  }

  /// One row that stands for each, in the two tables below.
  Imf::DeepFrameBuffer frame_buffer() {
    const std::ptrdiff_t left = header.dataWindow().min.x;
    const std::size_t pixels = counts.size();
    Imf::DeepFrameBuffer buffer;
    auto* first_count = reinterpret_cast<char*>(counts.data());
    buffer.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, first_count - left * std::ptrdiff_t{sizeof(std::uint32_t)}, sizeof(std::uint32_t), 0));
    for (std::size_t k = 0; k < channels.size(); ++k) {
      auto* first = reinterpret_cast<char*>(samples.data() + k * pixels);
      buffer.insert(channels[k], Imf::DeepSlice(Imf::FLOAT, first - left * std::ptrdiff_t{sizeof(float*)},
                                                sizeof(float*), 0, channels.size() * sizeof(float)));
    }
    return buffer;
  }

  void point_at(const std::uint32_t* row_counts, const float* row) {
    const std::size_t pixels = counts.size();
    std::copy_n(row_counts, pixels, counts.begin());
    std::fill(samples.begin(), samples.end(), nullptr);
    if (row == nullptr) return;  // no samples
    for (std::size_t x = 0; x < pixels; ++x) {
      for (std::size_t k = 0; k < channels.size(); ++k) samples[k * pixels + x] = row + k;
      row += row_counts[x] * channels.size();
    }
  }

  std::string path;
  Imf::Header header;
  std::vector<std::string> channels;
  std::vector<std::uint32_t> counts;
  std::vector<const float*> samples;  // the first of each pixel, channel after channel
  int rows_written = 0;
  ReplacingFile target;
  std::optional<Imf::MultiPartOutputFile> output;
  std::optional<Imf::DeepScanLineOutputPart> part;
};

SampleWriter::SampleWriter(const std::string& path, int width, int height, std::vector<std::string> channels,
                           const SampleWriterOptions& options) {
  check(path, width, height, channels, options.origin);
  with_io_errors("write '" + path + "'", [&] {
    Imf::Header header = header_for(width, height, channels, options);
    data_ = std::make_unique<Data>(path, std::move(header), std::move(channels));
  });
}

SampleWriter::SampleWriter(SampleWriter&&) noexcept = default;
SampleWriter& SampleWriter::operator=(SampleWriter&&) noexcept = default;
SampleWriter::~SampleWriter() = default;

void SampleWriter::write_row(const std::uint32_t* counts, const float* samples) {
  Data& data = *data_;
  const int height = height_of(data.header);
  if (data.rows_written == height)
    fail(data.path, "all of its " + std::to_string(height) + " rows are already written");
  const std::uint64_t total = std::accumulate(counts, counts + data.counts.size(), std::uint64_t{0});
  if (total * data.channels.size() * sizeof(float) > kMaxRowBytes) {
    fail(data.path, "row " + std::to_string(data.rows_written) + " has " + std::to_string(total) + " samples of " +
                        std::to_string(data.channels.size()) +
                        " channels, more than the 2^31 bytes that a row can have; write fewer samples per file");
  }
  if (samples == nullptr && total > 0) fail(data.path, "samples are counted, but none are given");
  with_io_errors("write '" + data.path + "'", [&] {
    data.point_at(counts, samples);
    data.part->writePixels(1);
  });
  ++data.rows_written;
}

void SampleWriter::finish() {
  Data& data = *data_;
  if (!data.output) fail(data.path, "it is finished already");
  const int height = height_of(data.header);
  if (data.rows_written != height) {
    fail(data.path,
         "only " + std::to_string(data.rows_written) + " of its " + std::to_string(height) + " rows were written");
  }
  with_io_errors("write '" + data.path + "'", [&] {
    data.part.reset();
    data.output.reset();
    data.target.commit();
  });
}

}  // namespace stein::exr
