// SPDX-License-Identifier: Apache-2.0
#include <ImfFloatAttribute.h>

#include <algorithm>
#include <deque>
#include <iterator>

#include "exr/loaded_frame.hpp"
#include "exr/output_plan.hpp"
#include "exr/part_writer.hpp"
#include "exr/perturbation_attributes.hpp"
#include "exr/replacing_file.hpp"
#include "exr/straight_alpha.hpp"
#include "exr/views.hpp"

namespace stein::exr {
namespace {

constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};

void check_size(const std::string& path, const Frame& frame, const std::string& plane, const Plane& given) {
  if (given.width() == frame.width && given.height() == frame.height) return;
  throw Error(ErrorCode::kInvalidArgument, "cannot write '" + path + "': " + plane + " of the result has " +
                                               std::to_string(given.width()) + " x " + std::to_string(given.height()) +
                                               " pixels, but the source '" + frame.origin + "' has " +
                                               std::to_string(frame.width) + " x " + std::to_string(frame.height));
}

/// `alpha`: the layer that must be there; empty: none.
void check_layers(const std::string& path, const ViewResult& view, const std::string& alpha) {
  const std::vector<FilteredLayer>& layers = view.result.layers;
  for (const FilteredLayer& layer : layers) {
    for (std::size_t c = 0; c < layer.mean.size(); ++c)
      check_size(path, view.source.frame(), plane_name(layer, c), layer.mean[c]);
  }
  const bool has_alpha = std::any_of(layers.begin(), layers.end(), [&](const FilteredLayer& layer) {
    return layer.name == alpha && layer.mean.size() == 1;
  });
  if (alpha.empty() || has_alpha) return;
  throw Error(ErrorCode::kInvalidArgument, "cannot write '" + path + "': the colour of '" + view.source.path() +
                                               "' was read as straight, and the result has no layer '" + alpha +
                                               "' to divide it by");
}

/// Sets where a layer's plane belongs: where the source has it.
void place(const SourceFile& file, const Layout& layout, MemoryChannel& channel) {
  for (std::size_t i = 0; i < layout.full_names.size(); ++i) {
    const SourceChannel& from = file.channels()[i];
    if (layout.full_names[i] != channel.name || !file.is_own(from.part)) continue;
    channel.name = from.name;
    channel.part = from.part;
    return;
  }
}

/// The layers, in the parts that have them.
std::vector<MemoryChannel> layer_channels(const DenoiseResult& result, const WriteOptions& options,
                                          const SourceFile& file, const Layout& layout, Straight& straight) {
  std::vector<MemoryChannel> channels;
  for (const FilteredLayer& layer : result.layers) {
    for (std::size_t c = 0; c < layer.mean.size(); ++c) {
      const std::string name = plane_name(layer, c);
      const ConstPlaneView plane = layer.mean.size() == 3 ? straight.divided(layer.mean[c], 1) : layer.mean[c].view();
      channels.push_back({name, options.half_colour ? Imf::HALF : Imf::FLOAT, plane});
      place(file, layout, channels.back());
    }
  }
  return channels;
}

/// What is new in the main part beside layers; the colour under the names it has there.
std::vector<MemoryChannel> result_channels(const std::string& path, const ViewResult& view, const WriteOptions& options,
                                           const std::array<std::string, 3>& names,
                                           const std::array<ConstPlaneView, 3>& file_colour, Straight& straight) {
  const DenoiseResult& result = view.result;
  std::vector<MemoryChannel> channels;
  const auto add = [&](const std::string& name, const Plane& plane, Imf::PixelType type, int alphas = 0) {
    check_size(path, view.source.frame(), name, plane);
    channels.push_back({name, type, alphas > 0 ? straight.divided(plane, alphas) : plane.view()});
  };
  for (std::size_t c = 0; c < 3; ++c) {
    add(names[c], result.colour[c], options.half_colour ? Imf::HALF : Imf::FLOAT, 1);
    if (options.error) add(std::string("error.") + kRgb[c], result.error[c], Imf::FLOAT, 2);
    const ConstPlaneView& noisy = file_colour[c];
    if (options.noisy) channels.push_back({std::string("noisy.") + kRgb[c], pixel_type(noisy.type()), noisy});
  }
  if (options.choice) add("choice.V", result.choice, Imf::FLOAT);
  if (options.density) add("density.V", result.density, Imf::FLOAT);
  return channels;
}

/// The source as it is now, which must still be the file that was read.
Layout reopened_layout(const SourceFile& file, const LoadedFrame& source, const Mapping& mapping) {
  Layout layout = lay_out(file, mapping);
  if (layout.main_part < 0 || file.channels().size() != source.channels().size() ||
      window_of(file.header(layout.main_part)) != source.data_window()) {
    throw Error(ErrorCode::kIo, "'" + file.path() + "' has changed since it was read; read it again");
  }
  return layout;
}

std::array<std::string, 3> colour_names(const SourceFile& file, const Layout& layout) {
  std::array<std::string, 3> names;
  for (std::size_t c = 0; c < 3; ++c) names[c] = file.channels()[static_cast<std::size_t>(layout.colour[c])].name;
  return names;
}

/// The colour under the names that it has, what is new beside it, and the layers.
std::vector<MemoryChannel> channels_of_view(const std::string& path, const ViewResult& view,
                                            const WriteOptions& options, const SourceFile& file, const Layout& layout,
                                            const std::array<ConstPlaneView, 3>& file_colour, Straight& straight) {
  const std::array<std::string, 3> colour = colour_names(file, layout);
  std::vector<MemoryChannel> channels = result_channels(path, view, options, colour, file_colour, straight);
  for (MemoryChannel& channel : channels) {
    const bool is_colour = std::find(colour.begin(), colour.end(), channel.name) != colour.end();
    if (!is_colour) channel.name = name_for_view(file, layout.main_part, view.source.view(), channel.name);
  }
  const std::vector<MemoryChannel> layers = layer_channels(view.result, options, file, layout, straight);
  channels.insert(channels.end(), layers.begin(), layers.end());
  return channels;
}

std::vector<MemoryChannel> channels_of(int part, const std::vector<MemoryChannel>& channels) {
  std::vector<MemoryChannel> own;
  std::copy_if(channels.begin(), channels.end(), std::back_inserter(own),
               [part](const MemoryChannel& channel) { return channel.part == part; });
  return own;
}

void write_parts(SourceFile& file, const std::vector<PartPlan>& plan, const std::vector<MemoryChannel>& channels,
                 const Memory* memory, Imf::OStream& stream) {
  std::vector<Imf::Header> headers;
  headers.reserve(plan.size());
  for (const PartPlan& part : plan) headers.push_back(part.header);
  Imf::MultiPartOutputFile output(stream, headers.data(), static_cast<int>(headers.size()));
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const int at = static_cast<int>(i);
    if (plan[i].copied) {
      copy_part(file, plan[i], output, at);
    } else {
      write_part(&file, plan[i], channels_of(plan[i].source_part, channels), output, at, memory);
    }
  }
}

/// All planes of a frame; layers, which come last, in the parts that have them.
std::vector<MemoryChannel> frame_channels(const Frame& frame, const SourceFile& file, const Layout& layout) {
  std::vector<MemoryChannel> channels;
  for (const auto& [name, view] : named_planes(frame)) channels.push_back({name, pixel_type(view.type()), view});
  std::size_t layer_planes = 0;
  for (const Layer& layer : frame.layers) layer_planes += layer.mean.size();
  for (std::size_t i = channels.size() - layer_planes; i < channels.size(); ++i) place(file, layout, channels[i]);
  return channels;
}

void insert_counts(const Frame& frame, Imf::Header& header) {
  if (!frame.sample_count) header.insert(kSamplesPerPixel, Imf::FloatAttribute(frame.uniform_sample_count));
  if (frame.degrees_of_freedom > 0) header.insert(kDegreesOfFreedom, Imf::FloatAttribute(frame.degrees_of_freedom));
}

/// Channels without a part go to the one with the colour.
void plan_new(std::vector<MemoryChannel>& channels, const Layout& layout, OutputRules& rules) {
  for (MemoryChannel& channel : channels) {
    if (channel.part < 0) channel.part = layout.main_part;
    rules.new_channels.push_back({channel.name, channel.type, channel.part});
  }
}

void require_frame_of(const std::string& path, const Frame& frame, const LoadedFrame& source,
                      const std::string& straight_alpha) {
  check(frame);
  if (!straight_alpha.empty()) {
    throw Error(ErrorCode::kUnsupported, "cannot write '" + path + "': the colour of '" + source.path() +
                                             "' was read as straight; only results can be written like it");
  }
  if (frame.width == source.frame().width && frame.height == source.frame().height) return;
  throw Error(ErrorCode::kInvalidArgument, "cannot write '" + path + "': the frame has " + std::to_string(frame.width) +
                                               " x " + std::to_string(frame.height) + " pixels, but the source '" +
                                               source.path() + "' has " + std::to_string(source.frame().width) + " x " +
                                               std::to_string(source.frame().height));
}

/// What `moved` has other planes of than the source's frame, under the names that it has in the file.
std::vector<MemoryChannel> moved_channels(const Frame& moved, const Frame& frame, const SourceFile& file,
                                          const Layout& layout) {
  std::vector<MemoryChannel> channels;
  const auto add = [&](int index, const ConstPlaneView& plane, const ConstPlaneView& old) {
    if (plane.data() == old.data()) return;
    const SourceChannel& from = file.channels()[static_cast<std::size_t>(index)];
    if (!file.is_own(from.part)) {
      throw Error(ErrorCode::kUnsupported, "'" + file.path() + "': the feature " + file.part_name(from.part) +
                                               " is in a file beside it; write all buffers into one file");
    }
    channels.push_back({from.name, Imf::FLOAT, plane, from.part});
  };
  for (std::size_t c = 0; c < 3; ++c) add(layout.colour[c], moved.colour[c], frame.colour[c]);
  for (std::size_t f = 0; f < layout.features.size(); ++f) {
    for (std::size_t k = 0; k < layout.features[f].mean.size(); ++k) {
      add(layout.features[f].mean[k], moved.features[f].mean[k], frame.features[f].mean[k]);
    }
  }
  return channels;
}

void write_whole(const std::string& path, SourceFile& file, const std::vector<PartPlan>& plan,
                 const std::vector<MemoryChannel>& channels, const Memory* memory) {
  ReplacingFile target(path);
  target.before_each_write([&file] { file.check_not_cancelled(); });
  write_parts(file, plan, channels, memory, target.stream());
  target.commit();
}

}  // namespace

void write_frame(const std::string& path, const Frame& frame, const LoadedFrame& source,
                 const std::function<bool(double)>& progress) {
  require_frame_of(path, frame, source, source.data_->straight_alpha);
  const Mapping& mapping = source.data_->mapping;
  with_io_errors("write '" + path + "' from '" + source.path() + "'", [&] {
    SourceFile file(source.path(), mapping.companions, progress);
    const Layout layout = reopened_layout(file, source, mapping);
    OutputRules rules{false, true, true, {}};
    std::vector<MemoryChannel> channels = frame_channels(frame, file, layout);
    plan_new(channels, layout, rules);
    std::vector<PartPlan> plan = plan_output(file, layout.roles, rules);
    for (PartPlan& part : plan) {
      if (part.source_part == layout.main_part) insert_counts(frame, part.header);
    }
    write_whole(path, file, plan, channels, source.data_->memory.get());
  });
}

void write_perturbed(const std::string& path, const Frame& moved, const LoadedFrame& source,
                     const Perturbation& perturbation, const std::function<bool(double)>& progress) {
  require_frame_of(path, moved, source, source.data_->straight_alpha);
  if (read_perturbation(source.path())) {
    throw Error(ErrorCode::kInvalidArgument, "'" + source.path() + "' is perturbed already; perturb the original");
  }
  with_io_errors("write '" + path + "' from '" + source.path() + "'", [&] {
    SourceFile file(source.path(), source.data_->mapping.companions, progress);
    const Layout layout = reopened_layout(file, source, source.data_->mapping);
    OutputRules rules;
    rules.keep_all = true;
    std::vector<MemoryChannel> channels = moved_channels(moved, source.frame(), file, layout);
    plan_new(channels, layout, rules);
    std::vector<PartPlan> plan = plan_output(file, layout.roles, rules);
    for (PartPlan& part : plan) {
      if (part.source_part == layout.main_part) insert_perturbation(perturbation, part.header);
    }
    write_whole(path, file, plan, channels, source.data_->memory.get());
  });
}

void write_result(const std::string& path, const LoadedFrame& source, const DenoiseResult& result,
                  const WriteOptions& options) {
  write_results(path, {{source, result}}, options);
}

void write_results(const std::string& path, const std::vector<ViewResult>& views, const WriteOptions& options) {
  if (views.empty()) throw Error(ErrorCode::kInvalidArgument, "cannot write '" + path + "': there is no result");
  const std::string& from = views.front().source.path();
  with_io_errors("write '" + path + "' from '" + from + "'", [&] {
    SourceFile file(from, views.front().source.data_->mapping.companions, options.progress);
    OutputRules rules{options.inputs, options.noisy, false, {}};
    std::vector<Role> roles(file.channels().size(), Role::kNone);
    std::vector<MemoryChannel> all;
    std::deque<Straight> straights;
    for (const ViewResult& view : views) {
      if (view.source.path() != from)
        throw Error(ErrorCode::kInvalidArgument, "'" + view.source.path() + "' and '" + from + "' are two files");
      const Layout layout = reopened_layout(file, view.source, view.source.data_->mapping);
      const LoadedFrame::Data& data = *view.source.data_;
      check_layers(path, view, data.straight_alpha);
      Straight& straight = straights.emplace_back(view.result, data.straight_alpha, data.memory.get());
      std::vector<MemoryChannel> channels =
          channels_of_view(path, view, options, file, layout, data.file_colour, straight);
      plan_new(channels, layout, rules);
      all.insert(all.end(), channels.begin(), channels.end());
      for (std::size_t i = 0; i < roles.size(); ++i) {
        if (layout.roles[i] != Role::kNone) roles[i] = layout.roles[i];
      }
    }
    write_whole(path, file, plan_output(file, roles, rules), all, views.front().source.data_->memory.get());
  });
}

}  // namespace stein::exr
