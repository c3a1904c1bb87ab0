// SPDX-License-Identifier: Apache-2.0
#include <ImfChannelList.h>
#include <ImfPartType.h>

#include <algorithm>
#include <stdexcept>

#include "exr/sample_layers.hpp"
#include "exr/sample_reader_data.hpp"

namespace stein::exr {
namespace {

constexpr const char* kRgb[] = {"R", "G", "B"};

[[noreturn]] void fail(ErrorCode code, const std::string& path, const std::string& why) {
  throw Error(code, "cannot read '" + path + "': " + why);
}

bool has_rgb(const Imf::Header& header) {
  return std::all_of(std::begin(kRgb), std::end(kRgb),
                     [&](const char* name) { return header.channels().findChannel(name) != nullptr; });
}

/// The first deep scanline part with R, G and B, or else the first one, which is then found to lack them.
int find_part(const SourceFile& file) {
  int found = -1;
  for (int part = 0; part < file.parts(); ++part) {
    if (!file.is_deep(part) || file.header(part).type() != Imf::DEEPSCANLINE) continue;
    if (has_rgb(file.header(part))) return part;
    if (found < 0) found = part;
  }
  if (found >= 0) return found;
  const bool any_deep = file.is_deep(0);
  fail(ErrorCode::kUnsupported, file.path(),
       std::string("it holds ") + (any_deep ? "deep tiles" : "planes, not samples") +
           "; raw samples are deep scanlines, one deep sample per Monte Carlo sample");
}

std::vector<std::string> names_of(const SourceFile& file, int part) {
  std::vector<std::string> names;
  for (const SourceChannel& channel : file.channels()) {
    if (channel.part != part) continue;
    if (channel.subsampled) {
      fail(ErrorCode::kUnsupported, file.path(),
           "channel " + channel.name + " is subsampled; write it in full resolution");
    }
    names.push_back(channel.name);
  }
  return names;
}

/// OpenEXR keeps a few bytes per row and pixel of the window: no more of them than the file can speak of.
void check_plausible(const SourceFile& file, int part) {
  constexpr std::int64_t kOffsetBytes = 8;
  const Imf::Header& header = file.header(part);
  const std::int64_t width = width_of(header);
  const std::int64_t height = height_of(header);
  const auto row_bytes = static_cast<std::int64_t>(DeepRow::kHeaderBytes) + kOffsetBytes;
  const std::int64_t ratio = largest_ratio(header.compression());
  const std::int64_t table_bytes = width * height * static_cast<std::int64_t>(sizeof(std::uint32_t));
  if (height > file.size(part) / row_bytes || table_bytes / ratio > file.size(part)) {
    fail(ErrorCode::kIo, file.path(),
         "its data window of " + std::to_string(width) + " x " + std::to_string(height) + " pixels cannot fit in its " +
             std::to_string(file.size(part)) + " bytes: it is truncated or damaged");
  }
}

std::vector<std::size_t> select_from(const std::string& path, const DeepRow& row,
                                     const std::vector<std::string>& channels) {
  std::vector<std::size_t> selection;
  for (const std::string& name : channels) {
    const auto at = std::find(row.channels().begin(), row.channels().end(), name);
    if (at == row.channels().end()) {
      fail(ErrorCode::kInvalidArgument, path, "its samples have no channel " + name);
    }
    selection.push_back(static_cast<std::size_t>(at - row.channels().begin()));
  }
  return selection;
}

}  // namespace

SampleReader::Data::Data(const std::string& path)
    : file(path),
      part(find_part(file)),
      layers(sample_layers(path, names_of(file, part))),
      channels(all_channels(layers)),
      row(header()),
      selection(select_from(path, row, channels)) {
  check_plausible(file, part);
  file.require_complete(part);
  input.emplace(file.input(part), part);
}

void SampleReader::Data::read_chunk(int y) {
  try {
    std::uint64_t bytes = 0;
    input->rawPixelData(y, nullptr, bytes);
    if (bytes > static_cast<std::uint64_t>(file.size(part))) {
      throw std::runtime_error("its chunk claims to be longer than the file: it is truncated or damaged");
    }
    // OpenEXR adds up what the file says, beyond 2^64, and writes its header into whatever it is given.
    if (bytes < DeepRow::kHeaderBytes)
      throw std::runtime_error("its chunk claims an impossible size: the file is damaged");
    chunk.resize(bytes);
    input->rawPixelData(y, chunk.data(), bytes);
  } catch (const Error& error) {  // of the stream, which knows of no rows
    throw Error(error.code(), error.what() + (" (row y = " + std::to_string(y) + ")"));
  }
}

SampleReader::SampleReader(const std::string& path)
    : data_(with_io_errors("read '" + path + "'", [&] { return std::make_unique<Data>(path); })) {}

SampleReader::SampleReader(SampleReader&&) noexcept = default;
SampleReader& SampleReader::operator=(SampleReader&&) noexcept = default;
SampleReader::~SampleReader() = default;

const std::string& SampleReader::path() const noexcept { return data_->file.path(); }
int SampleReader::width() const noexcept { return width_of(data_->header()); }
int SampleReader::height() const noexcept { return height_of(data_->header()); }
std::array<int, 4> SampleReader::data_window() const noexcept { return window_of(data_->header()); }
const std::vector<SampleLayer>& SampleReader::layers() const noexcept { return data_->layers; }
const std::vector<std::string>& SampleReader::channels() const noexcept { return data_->channels; }

void SampleReader::select(const std::vector<std::string>& channels) {
  check_channel_names("cannot read samples of '" + path() + "'", channels);
  data_->selection = select_from(path(), data_->row, channels);
  data_->channels = channels;
}

bool SampleReader::read_row(std::vector<std::uint32_t>& counts, std::vector<float>& samples) {
  Data& data = *data_;
  if (data.rows_read == height()) return false;
  const int y = data.header().dataWindow().min.y + data.rows_read;
  with_io_errors("read '" + path() + "', row y = " + std::to_string(y), [&] {
    data.read_chunk(y);
    data.row.decode(data.chunk.data(), data.chunk.size());
    const std::size_t channels = data.selection.size();
    samples.resize(data.row.samples() * channels);
    if (!samples.empty()) {  // else there is no address to add k to
      for (std::size_t k = 0; k < channels; ++k) data.row.read(data.selection[k], samples.data() + k, channels);
    }
    counts = data.row.counts();
  });
  ++data.rows_read;
  return true;
}

}  // namespace stein::exr
