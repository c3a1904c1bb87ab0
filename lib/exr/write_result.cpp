// SPDX-License-Identifier: Apache-2.0
#include <ImfFloatAttribute.h>

#include <algorithm>

#include "exr/loaded_frame.hpp"
#include "exr/output_plan.hpp"
#include "exr/part_writer.hpp"
#include "exr/replacing_file.hpp"

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

/// What is new in the main part; the colour under the names it has there.
std::vector<MemoryChannel> result_channels(const std::string& path, const Frame& frame, const DenoiseResult& result,
                                           const WriteOptions& options, const std::array<std::string, 3>& names) {
  std::vector<MemoryChannel> channels;
  const auto add = [&](const std::string& name, const Plane& plane, Imf::PixelType type) {
    check_size(path, frame, name, plane);
    channels.push_back({name, type, plane.view()});
  };
  for (std::size_t c = 0; c < 3; ++c) {
    add(names[c], result.colour[c], options.half_colour ? Imf::HALF : Imf::FLOAT);
    if (options.error) add(std::string("error.") + kRgb[c], result.error[c], Imf::FLOAT);
    const ConstPlaneView& noisy = frame.colour[c];
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

void write_parts(SourceFile& file, const std::vector<PartPlan>& plan, int main_part,
                 const std::vector<MemoryChannel>& channels, Imf::OStream& stream) {
  std::vector<Imf::Header> headers;
  headers.reserve(plan.size());
  for (const PartPlan& part : plan) headers.push_back(part.header);
  Imf::MultiPartOutputFile output(stream, headers.data(), static_cast<int>(headers.size()));
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const int at = static_cast<int>(i);
    if (plan[i].copied) {
      copy_part(file, plan[i], output, at);
    } else {
      write_part(&file, plan[i], plan[i].source_part == main_part ? channels : std::vector<MemoryChannel>(), output,
                 at);
    }
  }
}

std::vector<MemoryChannel> frame_channels(const Frame& frame) {
  std::vector<MemoryChannel> channels;
  for (const auto& [name, view] : named_planes(frame)) channels.push_back({name, pixel_type(view.type()), view});
  return channels;
}

void insert_counts(const Frame& frame, Imf::Header& header) {
  if (!frame.sample_count) header.insert(kSamplesPerPixel, Imf::FloatAttribute(frame.uniform_sample_count));
  if (frame.degrees_of_freedom > 0) header.insert(kDegreesOfFreedom, Imf::FloatAttribute(frame.degrees_of_freedom));
}

void write_whole(const std::string& path, SourceFile& file, const std::vector<PartPlan>& plan, int main_part,
                 const std::vector<MemoryChannel>& channels) {
  ReplacingFile target(path);
  write_parts(file, plan, main_part, channels, target.stream());
  target.commit();
}

}  // namespace

void write_frame(const std::string& path, const Frame& frame, const LoadedFrame& source) {
  check(frame);
  if (frame.width != source.frame().width || frame.height != source.frame().height) {
    throw Error(ErrorCode::kInvalidArgument,
                "cannot write '" + path + "': the frame has " + std::to_string(frame.width) + " x " +
                    std::to_string(frame.height) + " pixels, but the source '" + source.path() + "' has " +
                    std::to_string(source.frame().width) + " x " + std::to_string(source.frame().height));
  }
  const Mapping& mapping = source.data_->mapping;
  const std::vector<MemoryChannel> channels = frame_channels(frame);
  with_io_errors("write '" + path + "' from '" + source.path() + "'", [&] {
    SourceFile file(source.path(), mapping.companions);
    const Layout layout = reopened_layout(file, source, mapping);
    OutputRules rules{false, true, true, {}};
    for (const MemoryChannel& channel : channels) rules.new_channels.emplace_back(channel.name, channel.type);
    std::vector<PartPlan> plan = plan_output(file, layout, rules);
    for (PartPlan& part : plan) {
      if (part.source_part == layout.main_part) insert_counts(frame, part.header);
    }
    write_whole(path, file, plan, layout.main_part, channels);
  });
}

void write_result(const std::string& path, const LoadedFrame& source, const DenoiseResult& result,
                  const WriteOptions& options) {
  const Mapping& mapping = source.data_->mapping;
  with_io_errors("write '" + path + "' from '" + source.path() + "'", [&] {
    SourceFile file(source.path(), mapping.companions);
    const Layout layout = reopened_layout(file, source, mapping);
    const std::vector<MemoryChannel> channels =
        result_channels(path, source.frame(), result, options, colour_names(file, layout));
    OutputRules rules{options.inputs, options.noisy, false, {}};
    for (const MemoryChannel& channel : channels) rules.new_channels.emplace_back(channel.name, channel.type);
    const std::vector<PartPlan> plan = plan_output(file, layout, rules);
    write_whole(path, file, plan, layout.main_part, channels);
  });
}

}  // namespace stein::exr
