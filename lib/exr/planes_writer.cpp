// SPDX-License-Identifier: Apache-2.0
#include <ImfChannelList.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>

#include <optional>

#include "exr/output_plan.hpp"
#include "exr/part_reader.hpp"
#include "exr/replacing_file.hpp"
#include "exr/sample_layers.hpp"
#include "exr/sample_reader_data.hpp"
#include "stein/exr_samples.hpp"

namespace stein::exr {
namespace {

using PlaneRows = std::vector<std::pair<std::string, ConstPlaneView>>;

[[noreturn]] void fail(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::kInvalidArgument, "cannot write '" + path + "': " + why);
}

Imf::Header header_for(const Imf::Header& source, const std::vector<std::string>& channels) {
  Imf::Header header = scanline_header(source, false);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const std::string& name : channels) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  return header;
}

}  // namespace

struct PlanesWriter::Data {
  Data(const std::string& file_path, const Imf::Header& source, std::vector<std::string> names)
      : path(file_path), channels(std::move(names)), header(header_for(source, channels)), target(path) {
    output.emplace(target.stream(), &header, 1);
    part.emplace(*output, 0);
  }

  [[nodiscard]] int rows_left() const { return height_of(header) - rows_written; }

  void check(const PlaneRows& planes) const {
    if (planes.size() != channels.size()) {
      fail(path,
           std::to_string(planes.size()) + " planes are given for " + std::to_string(channels.size()) + " channels");
    }
    const int rows = planes.front().second.height();
    for (std::size_t k = 0; k < channels.size(); ++k) {
      const auto& [name, view] = planes[k];
      if (name != channels[k]) fail(path, "plane " + name + " is given where " + channels[k] + " should be");
      if (!view || view.width() != width_of(header) || view.height() != rows || rows < 1) {
        fail(path, "plane " + name + " has " + std::to_string(view.width()) + " x " + std::to_string(view.height()) +
                       " pixels, not " + std::to_string(width_of(header)) + " x " + std::to_string(rows));
      }
    }
    if (rows > rows_left()) {
      fail(path, std::to_string(rows) + " rows are given, but only " + std::to_string(rows_left()) + " are left");
    }
  }

  void write(const PlaneRows& planes) {
    const int rows = planes.front().second.height();
    const int width = width_of(header);
    const int first_y = header.dataWindow().min.y + rows_written;
    const std::size_t plane_size = static_cast<std::size_t>(width) * static_cast<std::size_t>(rows);
    values.resize(plane_size * planes.size());
    Imf::FrameBuffer buffer;
    float* to = values.data();
    for (const auto& [name, view] : planes) {
      buffer.insert(name, packed_slice(header, Imf::FLOAT, to, first_y, rows));
      for (int y = 0; y < rows; ++y, to += width) view.read_row(y, 0, width, to);
    }
    part->setFrameBuffer(buffer);
    part->writePixels(rows);
    rows_written += rows;
  }

  std::string path;
  std::vector<std::string> channels;
  Imf::Header header;
  std::vector<float> values;  // of the rows at hand
  int rows_written = 0;
  ReplacingFile target;
  std::optional<Imf::MultiPartOutputFile> output;
  std::optional<Imf::OutputPart> part;
};

PlanesWriter::PlanesWriter(const std::string& path, const SampleReader& source, std::vector<std::string> channels) {
  check_channel_names("cannot write '" + path + "'", channels);
  with_io_errors("write '" + path + "'",
                 [&] { data_ = std::make_unique<Data>(path, source.data_->header(), std::move(channels)); });
}

PlanesWriter::PlanesWriter(PlanesWriter&&) noexcept = default;
PlanesWriter& PlanesWriter::operator=(PlanesWriter&&) noexcept = default;
PlanesWriter::~PlanesWriter() = default;

void PlanesWriter::write_rows(const PlaneRows& planes) {
  data_->check(planes);
  with_io_errors("write '" + data_->path + "'", [&] { data_->write(planes); });
}

void PlanesWriter::finish() {
  Data& data = *data_;
  if (!data.output) fail(data.path, "it is finished already");
  if (data.rows_left() > 0) fail(data.path, "its last " + std::to_string(data.rows_left()) + " rows were not written");
  with_io_errors("write '" + data.path + "'", [&] {
    data.part.reset();
    data.output.reset();
    data.target.commit();
  });
}

}  // namespace stein::exr
