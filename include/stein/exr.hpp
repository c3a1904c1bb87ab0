// SPDX-License-Identifier: Apache-2.0
//
// stein::exr: frames from OpenEXR files and results into them (link stein::exr). Schema: docs/inputs.md.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "stein/candidate.hpp"
#include "stein/denoise.hpp"
#include "stein/frame.hpp"
#include "stein/memory.hpp"
#include "stein/plane.hpp"

#pragma GCC visibility push(default)
namespace stein::exr {

/// One channel of a file and what was made of it.
struct ChannelInfo {
  std::string part;  ///< name of the part; empty in single-part files
  std::string name;  ///< as in the file, such as "albedo.variance.R"
  std::string type;  ///< "half", "float" or "uint"
  std::string role;  ///< in words, such as "feature albedo, variance of the mean"; empty: not used, carried over
};

/// What the planes called variances are.
enum class VarianceOf : std::uint8_t {
  kAsStated,      ///< by the schema of the file
  kMean,          ///< variance of the mean
  kSample,        ///< variance of single samples, n times that of the mean
  kSecondMoment,  ///< mean of squares
};

/// Channels that make a plane group of the frame, whatever the schema says of them.
struct PlaneMap {
  std::string plane;                  ///< "colour", "samples", or the name of a feature
  std::vector<std::string> mean;      ///< full channel names: 3 for the colour, 1 for samples, 1 to 4 for a feature
  std::vector<std::string> variance;  ///< one per mean, or none
};

struct ReadOptions {
  /// Samples per pixel where the file has no `sampleCount` channel; 0: none given.
  float samples_per_pixel = 0;
  bool read_covariances = true;
  /// What goes into Frame::layers: "key" for the channels key.R, key.G and key.B, or the full name of a single channel
  /// such as "A". "all": every layer of R, G and B that is nothing else (no feature, no Cryptomatte), and alpha.
  std::vector<std::string> layers = {};
  /// false: a file without variances of the colour is read as well. Its frame lacks them, so that `check` refuses it.
  bool require_variance = true;
  std::string preset = {};                         ///< name of the schema; empty: found by the names of the channels
  std::vector<PlaneMap> maps = {};                 ///< before the schema
  VarianceOf variance_of = VarianceOf::kAsStated;  ///< of all variances, against the schema
  /// Of a file of several views (multiView, or parts with a view), such as "right"; empty: the default view. A view
  /// sees its own channels only, and parts without a view.
  std::string view = {};
  /// Where the planes lie: see memory.hpp. Null: on the heap. The results of this frame are written with it, too.
  std::shared_ptr<Memory> memory = nullptr;
  /// Called with the fraction read in [0, 1], in the calling thread, for each chunk of the file. Return false to
  /// cancel: Error kCancelled.
  std::function<bool(double)> progress = {};
  /// Colour and layers of R, G and B are divided by alpha, against OpenEXR's convention. They are multiplied by it,
  /// alpha becomes a layer, and results are written divided by the filtered alpha.
  bool straight_alpha = false;
};

struct ViewResult;
struct WriteOptions;

/// A frame read from a file together with the memory that its views look at. Movable; the views stay valid.
class LoadedFrame {
 public:
  LoadedFrame();
  LoadedFrame(LoadedFrame&&) noexcept;
  LoadedFrame& operator=(LoadedFrame&&) noexcept;
  ~LoadedFrame();

  [[nodiscard]] const Frame& frame() const noexcept;
  [[nodiscard]] const std::vector<ChannelInfo>& channels() const noexcept;  ///< all channels of all parts
  [[nodiscard]] const std::string& path() const noexcept;
  [[nodiscard]] std::array<int, 4> data_window()
      const noexcept;  ///< min x, min y, max x, max y of the part with the colour
  /// Y of the file's RGB primaries (attribute `chromaticities`), Rec. 709 where it has none.
  [[nodiscard]] std::array<float, 3> luminance_weights() const noexcept;
  /// Row-major 3x3 matrix from the file's RGB to linear Rec. 709 (no chromatic adaptation beyond the white points'
  /// own).
  [[nodiscard]] std::array<float, 9> to_rec709() const noexcept;
  /// What the schema knows of and the file lacks, in words with the consequence.
  [[nodiscard]] const std::vector<std::string>& missing() const noexcept;
  /// Whose names the channels bear, such as "pbrt (pbrt-v4, GBufferFilm)".
  [[nodiscard]] const std::string& schema() const noexcept;
  /// All views of the file, the default view first; empty where it has one only.
  [[nodiscard]] const std::vector<std::string>& views() const noexcept;
  [[nodiscard]] const std::string& view() const noexcept;  ///< which of them this is
  /// What is taken for granted though the file does not say it, in words.
  [[nodiscard]] const std::vector<std::string>& assumptions() const noexcept;

  struct Data;

 private:
  friend LoadedFrame read_frame(const std::string& path, const ReadOptions& options);
  friend void write_results(const std::string& path, const std::vector<ViewResult>& views, const WriteOptions& options);
  friend void write_frame(const std::string& path, const Frame& frame, const LoadedFrame& source,
                          const std::function<bool(double)>& progress);
  friend void write_perturbed(const std::string& path, const Frame& moved, const LoadedFrame& source,
                              const Perturbation& perturbation, const std::function<bool(double)>& progress);
  std::unique_ptr<Data> data_;
};

/// Reads a single- or multi-part, scanline or tiled file of half, float or uint channels in one of the schemas of
/// docs/inputs.md; where a renderer writes a file per buffer, the files beside it as well.
/// @throws Error kIo (cannot open, truncated), kUnsupported (deep, subsampled), kInvalidFrame (planes missing),
/// kInvalidArgument (options), naming file and channel.
[[nodiscard]] LoadedFrame read_frame(const std::string& path, const ReadOptions& options = {});

/// Any planes of a file by full channel names, whatever the schema: for comparing and looking.
struct NamedPlanes {
  std::vector<std::string> names;
  std::vector<Plane> planes;
  std::array<int, 4> data_window{};
  std::array<float, 9> to_rec709{};
};

/// Reads the channels named, or, where `names` is empty, the colour as R, G and B. A name may carry its part as
/// "part/channel". `memory`: where the planes lie, as ReadOptions::memory.
/// @throws Error as read_frame.
[[nodiscard]] NamedPlanes read_planes(const std::string& path, const std::vector<std::string>& names = {},
                                      Memory* memory = nullptr);

struct WriteOptions {
  bool error = true;         ///< error.R/G/B
  bool choice = true;        ///< choice.V
  bool density = true;       ///< density.V
  bool noisy = false;        ///< the input's colour as noisy.R/G/B
  bool inputs = false;       ///< keep the planes that describe the noisy input: variances, covariances, sampleCount
  bool half_colour = false;  ///< R, G, B and layers as half (float otherwise); what half cannot hold becomes +-65504
  /// As that of ReadOptions, for each chunk of the source and of the output; cancelled, there is no output.
  std::function<bool(double)> progress = {};
};

/// Writes the result, its layers under the names that they have in the file, next to everything of `source` that does
/// not describe its noise: other channels, parts and attributes are carried over bit for bit, streamed from the
/// source's file, which `path` may be as well. Parts that lose or gain channels, always the one with the colour, are
/// written as scanlines, also where the source has tiles (of a pyramid, its full size), with ZIP where its compression
/// is lossy. Error, choice and density of an earlier run are dropped. The file appears whole or not at all (temporary
/// file .NAME.*.stein-tmp in the same folder, renamed; those of writers that were killed go when the file is next
/// written).
/// @throws Error kIo naming the file; kInvalidArgument if the result is not of the source's size.
void write_result(const std::string& path, const LoadedFrame& source, const DenoiseResult& result,
                  const WriteOptions& options = {});

/// A view of a file, and what it was filtered to.
struct ViewResult {
  const LoadedFrame& source;
  const DenoiseResult& result;
};

/// The same for several views of one file. New channels bear the view's name where its channels do: error.right.R.
void write_results(const std::string& path, const std::vector<ViewResult>& views, const WriteOptions& options = {});

/// Writes a frame in the native schema in place of the one in `source`; everything else of `source` is carried over as
/// by `write_result`, its earlier results and noisy colours left out. `progress`: as that of WriteOptions.
/// @throws Error kInvalidFrame, kIo naming the file, kInvalidArgument if the frame is not of the source's size.
void write_frame(const std::string& path, const Frame& frame, const LoadedFrame& source,
                 const std::function<bool(double)>& progress = {});

/// Writes a file like that of `source`, all its channels, parts and attributes, but with colour and features as `moved`
/// has them (as float), which must be of the source's frame (PerturbedFrame); and with attributes that say how it was
/// moved. Parts that are changed are written as by `write_result`. `progress`: as that of WriteOptions.
/// @throws Error kIo naming the file; kInvalidArgument if the frame is not of the source's size, or the source was
/// moved already; kUnsupported if the source has features in other files.
void write_perturbed(const std::string& path, const Frame& moved, const LoadedFrame& source,
                     const Perturbation& perturbation, const std::function<bool(double)>& progress = {});

/// How the file was moved, by its attributes perturbationSeed, perturbationDraw and perturbationStep, if it has them.
/// @throws Error kIo; kInvalidFrame for attributes that cannot be.
[[nodiscard]] std::optional<Perturbation> read_perturbation(const std::string& path);

/// A plain file of named planes of one size, written whole or not at all: uint planes as uint, others as float.
/// `origin`: x and y of the first pixel in the file's data window.
void write_planes(const std::string& path, const std::vector<std::pair<std::string, ConstPlaneView>>& planes,
                  const std::array<int, 2>& origin = {0, 0});

/// Any bytes as a file, written as the images are: whole or not at all. @throws Error kIo naming the file.
void write_bytes(const std::string& path, std::string_view bytes);

}  // namespace stein::exr
#pragma GCC visibility pop
