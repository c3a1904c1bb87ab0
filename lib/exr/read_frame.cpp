// SPDX-License-Identifier: Apache-2.0
#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfIntAttribute.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "exr/convert_variance.hpp"
#include "exr/layers.hpp"
#include "exr/layout.hpp"
#include "exr/loaded_frame.hpp"
#include "exr/part_reader.hpp"
#include "exr/straight_alpha.hpp"
#include "exr/views.hpp"

namespace stein::exr {
namespace {

class FrameReader {
 public:
  FrameReader(const std::string& path, const ReadOptions& options, LoadedFrame::Data& data)
      : options_(options),
        data_(data),
        mapping_(mapping_of(path, options)),
        file_(path, mapping_.companions, options.progress),
        layout_(lay_out(file_, mapping_)) {}

  void read() {
    require_colour();
    const Imf::Header& main = file_.header(layout_.main_part);
    data_.path = file_.path();
    data_.memory = options_.memory;
    data_.mapping = mapping_;
    data_.views = list_views(file_);
    data_.view = mapping_.view.empty() && !data_.views.empty() ? data_.views.front() : mapping_.view;
    data_.schema = std::string(mapping_.schema->name) + " (" + std::string(mapping_.schema->renderer) + ")";
    data_.missing = layout_.missing;
    if (layout_.variance[0] < 0) data_.missing.push_back("no variance of the colour: " + remedy());
    data_.data_window = window_of(main);
    data_.colour_space = colour_space(main, file_.path());
    data_.frame.width = width_of(main);
    data_.frame.height = height_of(main);
    data_.frame.origin = file_.path() + (mapping_.view.empty() ? "" : ", view " + mapping_.view);
    find_sample_count();
    data_.frame.degrees_of_freedom = attribute(kDegreesOfFreedom);
    choose_planes();
    read_planes();
    fill_frame();
    convert_variances();
    data_.file_colour = data_.frame.colour;
    if (options_.straight_alpha) premultiply(view(layout_.alpha), data_.frame, options_.memory.get(), data_.converted);
    list_channels();
  }

 private:
  static Mapping mapping_of(const std::string& path, const ReadOptions& options) {
    Mapping mapping = find_mapping(path, options.preset, options.view);
    mapping.maps = options.maps;
    mapping.variance_of = options.variance_of;
    return mapping;
  }

  /// The file, and the view where one was asked for.
  [[nodiscard]] std::string named() const {
    return "'" + file_.path() + "'" + (mapping_.view.empty() ? "" : ", view " + mapping_.view);
  }

  [[noreturn]] void fail(ErrorCode code, const std::string& what) const { throw Error(code, named() + ": " + what); }

  void require_colour() const {
    const int main = layout_.main_part;
    if (main >= 0 && file_.is_deep(main)) {
      fail(ErrorCode::kUnsupported,
           "R, G, B are deep; stein reads the colour from a flat part: accumulate raw samples ('stein accumulate'), "
           "flatten other deep images");
    }
    std::string missing = absent(layout_.colour, "");
    if (!missing.empty()) {
      fail(ErrorCode::kInvalidFrame, "it has no " + missing + ", the noisy colour; it has " + some_names() +
                                         ". Rename the channels to stein's names (docs/inputs.md)");
    }
    missing = absent(layout_.variance, "variance.");
    const bool has_some = std::any_of(layout_.variance.begin(), layout_.variance.end(), [](int i) { return i >= 0; });
    if (!missing.empty() && (options_.require_variance || has_some)) {
      fail(ErrorCode::kInvalidFrame,
           "it has no " + missing + ", the variance of the mean colour; " + remedy() + "; it has " + some_names());
    }
  }

  [[nodiscard]] std::string remedy() const {
    const std::string_view stated = mapping_.schema->without_variance;
    return (stated.empty() ? "have the renderer write it, accumulate it from the samples, or merge several renders"
                           : std::string(stated)) +
           " (docs/inputs.md)";
  }

  static std::string absent(const std::array<int, 3>& channels, const std::string& layer) {
    std::string names;
    for (std::size_t i = 0; i < 3; ++i) {
      if (channels[i] < 0) names += (names.empty() ? "" : ", ") + layer + "RGB"[i];
    }
    return names;
  }

  [[nodiscard]] std::string some_names() const {
    constexpr std::size_t kShown = 12;
    std::vector<std::string> names = layout_.full_names;
    std::erase(names, "");
    std::string list = names.empty() ? "no channels" : "";
    for (std::size_t i = 0; i < std::min(kShown, names.size()); ++i) list += (i == 0 ? "" : ", ") + names[i];
    return names.size() > kShown ? list + ", ..." : list;
  }

  void find_sample_count() {
    if (layout_.sample_count >= 0) return;
    const std::string name = samples_attribute();
    float stated = attribute(name);
    if (stated < 1) stated = attribute(kSamplesPerPixel);
    if (stated >= 1 || options_.samples_per_pixel >= 1) {
      data_.frame.uniform_sample_count = stated >= 1 ? stated : options_.samples_per_pixel;
      data_.missing.push_back("no sampleCount: every pixel is taken to have " +
                              std::to_string(std::lround(data_.frame.uniform_sample_count)) + " samples, as " +
                              (stated >= 1 ? "the attribute " + name + " says" : "given"));
      return;
    }
    if (mapping_.schema->assumed_samples < 1 || variances_need_samples()) {
      fail(ErrorCode::kInvalidFrame,
           "it has neither a channel sampleCount nor an attribute samplesPerPixel" +
               std::string(variances_need_samples() ? ", and its variances can only be told with the number of "
                                                      "samples"
                                                    : "") +
               "; pass the number of samples per pixel (--samples N)");
    }
    data_.frame.uniform_sample_count = mapping_.schema->assumed_samples;
    data_.assumptions.push_back("the number of samples is not stated, and taken as " +
                                std::to_string(std::lround(data_.frame.uniform_sample_count)) +
                                "; the variances do not depend on it (--samples N says it)");
  }

  [[nodiscard]] std::string samples_attribute() const {
    std::string name(mapping_.schema->samples_attribute);
    const std::size_t layer = name.find("<layer>");
    return layer == std::string::npos ? name : name.replace(layer, 7, mapping_.bindings.layer);
  }

  [[nodiscard]] bool variances_need_samples() const {
    return (layout_.variance[0] >= 0 && needs_samples(layout_.variance_of)) ||
           std::any_of(layout_.features.begin(), layout_.features.end(),
                       [](const FeatureLayout& f) { return !f.variance.empty() && needs_samples(f.variance_of); });
  }

  /// A number of the header; 0 where there is none that is positive.
  [[nodiscard]] float attribute(const std::string& name) const {
    const Imf::Header& header = file_.header(layout_.main_part);
    float value = 0;
    if (const auto* whole = header.findTypedAttribute<Imf::IntAttribute>(name)) {
      value = static_cast<float>(whole->value());
    } else if (const auto* real = header.findTypedAttribute<Imf::FloatAttribute>(name)) {
      value = real->value();
    } else if (const auto* text = header.findTypedAttribute<Imf::StringAttribute>(name)) {
      value = std::strtof(text->value().c_str(), nullptr);
    }
    return std::isfinite(value) && value > 0 ? value : 0;
  }

  void choose_planes() {
    views_.resize(file_.channels().size());
    require_full_resolution();
    choose(layout_.colour);
    choose(layout_.variance);
    choose(std::array{layout_.sample_count});
    if (options_.read_covariances) choose(layout_.covariance);
    for (const FeatureLayout& feature : layout_.features) {
      choose(feature.mean);
      choose(feature.variance);
      if (options_.read_covariances) choose(feature.covariance);
    }
    layers_ = find_layers(file_, layout_, wanted_layers());
    for (const LayerLayout& layer : layers_) choose(layer.mean);
  }

  /// Alpha, by which straight colour is divided, has to be filtered as well.
  std::vector<std::string> wanted_layers() {
    std::vector<std::string> names = options_.layers;
    if (!options_.straight_alpha) return names;
    if (layout_.alpha < 0) {
      fail(ErrorCode::kInvalidArgument,
           "its colour is said to be straight, divided by alpha, but it has no alpha; read it as it is");
    }
    data_.straight_alpha = layout_.full_names[static_cast<std::size_t>(layout_.alpha)];
    data_.assumptions.push_back("the colour is straight: it was multiplied by " + data_.straight_alpha);
    names.push_back(data_.straight_alpha);
    return names;
  }

  /// Of all channels of the main part: what is not read is carried over row by row.
  void require_full_resolution() const {
    for (std::size_t i = 0; i < file_.channels().size(); ++i) {
      const SourceChannel& from = file_.channels()[i];
      if (from.part == layout_.main_part && from.subsampled) refuse(static_cast<int>(i));
    }
  }

  [[nodiscard]] const SourceChannel& channel(int index) const {
    return file_.channels()[static_cast<std::size_t>(index)];
  }

  [[nodiscard]] bool fits(const SourceChannel& channel) const {
    return window_of(file_.header(channel.part)) == data_.data_window && !channel.subsampled;
  }

  template <class Indices>
  void choose(const Indices& indices) {
    for (const int index : indices) {
      if (index < 0) continue;
      if (!fits(channel(index))) refuse(index);
      if (std::find(planes_.begin(), planes_.end(), index) == planes_.end()) planes_.push_back(index);
    }
  }

  [[noreturn]] void refuse(int index) const {
    const std::string& name = layout_.full_names[static_cast<std::size_t>(index)];
    if (channel(index).subsampled) {
      fail(ErrorCode::kUnsupported, "channel " + name + " is subsampled; write it at full resolution");
    }
    fail(ErrorCode::kInvalidFrame, "the data window of part '" + file_.part_name(channel(index).part) + "' with " +
                                       name + " differs from that of the colour; write both with the same data window");
  }

  /// One allocation for all planes, each in the file's own type; a part is read straight into it.
  void read_planes() {
    const std::size_t pixels =
        static_cast<std::size_t>(data_.frame.width) * static_cast<std::size_t>(data_.frame.height);
    // Planes that start at equal addresses modulo 4096 fight for the same cache sets: each start moves on a few lines.
    constexpr std::size_t kStagger = 5 * PlaneMemory::kAlignment;
    std::size_t bytes = 0;
    std::vector<std::size_t> offsets;
    for (const int index : planes_) {
      offsets.push_back(bytes);
      bytes += pixels * static_cast<std::size_t>(byte_size(scalar_type(channel(index).type))) + kStagger;
      bytes = (bytes + PlaneMemory::kAlignment - 1) / PlaneMemory::kAlignment * PlaneMemory::kAlignment;
    }
    data_.planes = options_.memory ? PlaneMemory(bytes, *options_.memory) : PlaneMemory(bytes);
    std::vector<Imf::FrameBuffer> targets(static_cast<std::size_t>(file_.parts()));
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      const SourceChannel& from = channel(planes_[i]);
      const std::byte* to = data_.planes.data() + offsets[i];
      const Imf::Header& header = file_.header(from.part);
      targets[static_cast<std::size_t>(from.part)].insert(
          from.name, packed_slice(header, from.type, to, header.dataWindow().min.y, data_.frame.height));
      views_[static_cast<std::size_t>(planes_[i])] =
          ConstPlaneView(to, scalar_type(from.type), data_.frame.width, data_.frame.height);
    }
    for (int part = 0; part < file_.parts(); ++part) {
      const Imf::FrameBuffer& target = targets[static_cast<std::size_t>(part)];
      if (target.begin() == target.end()) continue;
      const auto row_bytes = static_cast<std::int64_t>(planes_.size() * sizeof(float)) * data_.frame.width;
      PartReader(file_, part).read_all(target, row_bytes, options_.memory.get());
    }
  }

  [[nodiscard]] ConstPlaneView view(int index) const {
    return index < 0 ? ConstPlaneView() : views_[static_cast<std::size_t>(index)];
  }

  [[nodiscard]] std::array<ConstPlaneView, 3> views(const std::array<int, 3>& indices) const {
    return {view(indices[0]), view(indices[1]), view(indices[2])};
  }

  [[nodiscard]] std::vector<ConstPlaneView> views(const std::vector<int>& indices) const {
    std::vector<ConstPlaneView> result;
    result.reserve(indices.size());
    for (const int index : indices) result.push_back(view(index));
    return result;
  }

  void fill_frame() {
    Frame& frame = data_.frame;
    frame.colour = views(layout_.colour);
    frame.colour_variance = views(layout_.variance);
    frame.colour_covariance = views(layout_.covariance);
    frame.sample_count = view(layout_.sample_count);
    for (const FeatureLayout& feature : layout_.features) {
      frame.features.push_back({feature.name, views(feature.mean), views(feature.variance), {}});
      if (options_.read_covariances) frame.features.back().colour_covariance = views(feature.covariance);
    }
    for (const LayerLayout& layer : layers_) frame.layers.push_back({layer.name, views(layer.mean)});
  }

  void convert_variances() {
    Frame& frame = data_.frame;
    convert_colour_variance(frame, *mapping_.schema, layout_.variance_of, data_.colour_space, options_.memory.get(),
                            data_.converted);
    for (std::size_t i = 0; i < frame.features.size(); ++i) {
      convert_feature_variance(frame, frame.features[i], layout_.features[i].variance_of, options_.memory.get(),
                               data_.converted);
    }
    const auto& assumed = mapping_.schema->assumptions;
    data_.assumptions.insert(data_.assumptions.end(), assumed.begin(), assumed.end());
  }

  void list_channels() {
    for (std::size_t i = 0; i < file_.channels().size(); ++i) {
      const SourceChannel& from = file_.channels()[i];
      const char* type = from.type == Imf::HALF ? "half" : from.type == Imf::UINT ? "uint" : "float";
      data_.channels.push_back(
          {file_.parts() > 1 ? file_.part_name(from.part) : "", from.name, type, layout_.words[i]});
    }
    for (const LayerLayout& layer : layers_) {
      for (const int channel : layer.mean) {
        std::string& role = data_.channels[static_cast<std::size_t>(channel)].role;
        if (role.empty()) role = "layer " + layer.name;
      }
    }
  }

  const ReadOptions& options_;
  LoadedFrame::Data& data_;
  Mapping mapping_;
  SourceFile file_;
  Layout layout_;
  std::vector<LayerLayout> layers_;
  std::vector<int> planes_;            // to be read, as channel indices
  std::vector<ConstPlaneView> views_;  // per channel of the file; absent where not read
};

void check_map(const PlaneMap& map) {
  const std::size_t most = map.plane == "colour" ? 3 : map.plane == "samples" ? 1 : 4;
  const std::size_t least = map.plane == "colour" ? 3 : 1;
  const std::size_t count = map.mean.size();
  if (map.plane.empty() || count < least || count > most) {
    throw Error(ErrorCode::kInvalidArgument, "the map of plane '" + map.plane + "' has " + std::to_string(count) +
                                                 " channels; give 3 for colour, 1 for samples, 1 to 4 for a feature");
  }
  if (!map.variance.empty() && (map.variance.size() != count || map.plane == "samples")) {
    throw Error(ErrorCode::kInvalidArgument, "the map of plane '" + map.plane + "' has " +
                                                 std::to_string(map.variance.size()) + " variances for " +
                                                 std::to_string(count) + " channels; give one for each or none");
  }
}

}  // namespace

LoadedFrame read_frame(const std::string& path, const ReadOptions& options) {
  for (const PlaneMap& map : options.maps) check_map(map);
  if (!(options.samples_per_pixel >= 0) || !std::isfinite(options.samples_per_pixel)) {
    throw Error(ErrorCode::kInvalidArgument, "ReadOptions::samples_per_pixel is " +
                                                 std::to_string(options.samples_per_pixel) +
                                                 "; it must be a finite number, and 0 or at least 1");
  }
  LoadedFrame loaded;
  with_io_errors("read '" + path + "'", [&] { FrameReader(path, options, *loaded.data_).read(); });
  return loaded;
}

}  // namespace stein::exr
