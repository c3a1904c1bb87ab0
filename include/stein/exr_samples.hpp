// SPDX-License-Identifier: Apache-2.0
//
// Raw Monte Carlo samples in files (link stein::exr): deep scanline OpenEXR, one deep sample per Monte Carlo sample.
// Everything is streamed by rows, from the top: a file may be larger than memory. Layout and limits: docs/inputs.md.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "stein/plane.hpp"
#include "stein/rpf.hpp"

#pragma GCC visibility push(default)
namespace stein::exr {

struct SampleWriterOptions {
  std::array<int, 2> origin = {0, 0};  ///< x and y of the first pixel in the file's data window
  bool compress = true;                ///< ZIPS, without loss; otherwise none: faster to write, larger
};

/// Writes a file of samples. It appears under its name whole or not at all (temporary file in the same folder,
/// renamed).
class SampleWriter {
 public:
  /// Channels: R, G, B and any others, such as "albedo.R", "depth.Z", "random.lens.X", in any order; all are written as
  /// floats.
  /// @throws Error kInvalidArgument (size, channels: R, G and B missing, a name twice), kIo naming the file.
  SampleWriter(const std::string& path, int width, int height, std::vector<std::string> channels,
               const SampleWriterOptions& options = {});
  SampleWriter(SampleWriter&&) noexcept;
  SampleWriter& operator=(SampleWriter&&) noexcept;
  ~SampleWriter();  ///< without `finish`: removes the temporary file

  /// The next row. `counts`: samples of each of its `width` pixels, which may be 0. `samples`: those of the first
  /// pixel, then those of the next; each sample is one float per channel, in the order of the channels given. `samples`
  /// may be null where all counts are 0.
  /// @throws Error kInvalidArgument (more rows than the height, a row beyond 2^31 - 1 bytes), kIo naming the file.
  void write_row(const std::uint32_t* counts, const float* samples);

  /// Brings the file under its name. Nothing else may be called after it.
  /// @throws Error kInvalidArgument if rows are missing, kIo naming the file.
  void finish();

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

/// What belongs together among the channels of a file of samples.
struct SampleLayer {
  enum class Kind : std::uint8_t {
    kColour,   ///< R, G, B
    kFeature,  ///< "normal" with normal.X, normal.Y, normal.Z; 1 to 4 channels
    kRandom,   ///< "random.lens" with random.lens.X, random.lens.Y: what the sample was drawn with
    kOther,    ///< not understood: alpha, the depth of deep images (Z), variances, ...
  };
  Kind kind = Kind::kOther;
  std::string name;                   ///< empty for the colour
  std::vector<std::string> channels;  ///< full names, components in conventional order (RGB, XYZ)
};

/// Reads a file of samples: the first deep scanline part that has R, G and B. Channels may be half, float or uint.
class SampleReader {
 public:
  /// @throws Error kIo (cannot open, truncated), kUnsupported (no deep scanlines, tiles), kInvalidFrame (no R, G, B),
  /// naming file and channel.
  explicit SampleReader(const std::string& path);
  SampleReader(SampleReader&&) noexcept;
  SampleReader& operator=(SampleReader&&) noexcept;
  ~SampleReader();

  [[nodiscard]] const std::string& path() const noexcept;
  [[nodiscard]] int width() const noexcept;
  [[nodiscard]] int height() const noexcept;
  [[nodiscard]] std::array<int, 4> data_window() const noexcept;  ///< min x, min y, max x, max y
  /// All of the file: the colour, features, random parameters, others.
  [[nodiscard]] const std::vector<SampleLayer>& layers() const noexcept;
  /// What `read_row` delivers, in this order; at first the channels of all layers.
  [[nodiscard]] const std::vector<std::string>& channels() const noexcept;

  /// From now on rows hold these channels, in this order.
  /// @throws Error kInvalidArgument for a name that the file does not have, or that is given twice.
  void select(const std::vector<std::string>& channels);

  /// The next row: `counts` of its pixels; `samples` pixel by pixel, sample by sample, the channels of a sample one
  /// after the other. False after the last row. Memory is asked for only once the counts are known to fit what the file
  /// holds of the row.
  /// @throws Error kIo naming file and row (truncated, damaged).
  [[nodiscard]] bool read_row(std::vector<std::uint32_t>& counts, std::vector<float>& samples);

 private:
  friend class PlanesWriter;
  struct Data;
  std::unique_ptr<Data> data_;
};

/// The features and random parameters of a file for random parameter filtering. Selects the reader's channels; the
/// reader must outlive the source, and have no row read yet.
[[nodiscard]] SampleSource sample_source(SampleReader& reader);

/// Writes what was computed from samples as planes, a band of rows at a time: float channels under the window and the
/// attributes (such as chromaticities) of the samples' file. The file appears whole or not at all.
class PlanesWriter {
 public:
  /// @throws Error kInvalidArgument (no channels, a name twice), kIo naming the file.
  PlanesWriter(const std::string& path, const SampleReader& source, std::vector<std::string> channels);
  PlanesWriter(PlanesWriter&&) noexcept;
  PlanesWriter& operator=(PlanesWriter&&) noexcept;
  ~PlanesWriter();  ///< without `finish`: removes the temporary file

  /// The next rows, as many as the views have: one view per channel, under the names and in the order given.
  /// @throws Error kInvalidArgument (other names, sizes or more rows than the window has), kIo naming the file.
  void write_rows(const std::vector<std::pair<std::string, ConstPlaneView>>& planes);

  /// Brings the file under its name. Nothing else may be called after it.
  /// @throws Error kInvalidArgument if rows are missing, kIo naming the file.
  void finish();

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace stein::exr
#pragma GCC visibility pop
