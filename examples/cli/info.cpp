// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "frame_text.hpp"
#include "mapping_options.hpp"
#include "plane_statistics.hpp"
#include "stein/exr.hpp"
#include "stein/frame.hpp"
#include "verbs.hpp"

namespace stein::cli {
namespace {

struct InfoOptions {
  std::string input;
  MappingOptions mapping;
  SamplesOption samples;
  bool json = false;
};

constexpr const char* kInfoFooter =
    "Examples:\n"
    "  stein info noisy.exr\n"
    "  stein info noisy.exr --json";

void print_list(const char* title, const std::vector<std::string>& lines) {
  if (!lines.empty()) std::printf("\n%s\n", title);
  for (const std::string& text : lines) {
    std::printf("  %s\n", text.c_str());
  }
}

std::string view_list(const exr::LoadedFrame& input) {
  std::string list;
  for (const std::string& view : input.views()) list += (list.empty() ? "" : ", ") + view;
  return list;
}

void print_text(const exr::LoadedFrame& input, const FrameReport& report) {
  const Frame& frame = input.frame();
  std::printf("%s\n%s\nschema: %s\nsamples: %s\n", input.path().c_str(), size_text(input).c_str(),
              input.schema().c_str(), samples_text(frame).c_str());
  if (!input.views().empty()) std::printf("view: %s, of %s\n", input.view().c_str(), view_list(input).c_str());
  if (frame.colour_variance[0]) std::printf("invalid pixels: %lld\n", static_cast<long long>(report.invalid_pixels));
  for (std::size_t i = 0; i < report.bad_feature_pixels.size(); ++i) {
    std::printf("pixels without a usable %s: %lld\n", frame.features[i].name.c_str(),
                static_cast<long long>(report.bad_feature_pixels[i]));
  }
  std::printf("\nchannels\n");
  for (const exr::ChannelInfo& channel : input.channels()) {
    const std::string name = channel.part.empty() ? channel.name : channel.part + "/" + channel.name;
    std::printf("  %-28s %-6s %s\n", name.c_str(), channel.type.c_str(),
                channel.role.empty() ? "not used, carried over" : channel.role.c_str());
  }
  std::printf("\n%-28s %12s %12s %12s %10s\n", "planes", "min", "mean", "max", "non-finite");
  for (const auto& [name, plane] : named_planes(frame)) {
    const PlaneStatistics s = statistics(plane);
    std::printf("  %-26s %12.5g %12.5g %12.5g %10lld\n", name.c_str(), s.minimum, s.mean, s.maximum,
                static_cast<long long>(s.non_finite));
  }
  print_list("missing", input.missing());
  print_list("assumed", input.assumptions());
}

nlohmann::ordered_json samples_json(const Frame& frame) {
  nlohmann::ordered_json json = {{"min", frame.uniform_sample_count}, {"max", frame.uniform_sample_count}};
  if (frame.sample_count) {
    const PlaneStatistics count = statistics(frame.sample_count);
    json = {{"min", count.minimum}, {"max", count.maximum}};
  }
  if (frame.degrees_of_freedom > 0) {
    json["degrees_of_freedom"] = frame.degrees_of_freedom;
  }
  return json;
}

void print_json(const exr::LoadedFrame& input, const FrameReport& report) {
  using Json = nlohmann::ordered_json;
  const Frame& frame = input.frame();
  Json bad_features = Json::object();
  for (std::size_t i = 0; i < report.bad_feature_pixels.size(); ++i) {
    bad_features[frame.features[i].name] = report.bad_feature_pixels[i];
  }
  Json channels = Json::array();
  for (const exr::ChannelInfo& c : input.channels()) {
    channels.push_back({{"part", c.part}, {"name", c.name}, {"type", c.type}, {"role", c.role}});
  }
  Json planes = Json::object();
  for (const auto& [name, plane] : named_planes(frame)) {
    const PlaneStatistics s = statistics(plane);
    planes[name] = {{"min", s.minimum}, {"mean", s.mean}, {"max", s.maximum}, {"non_finite", s.non_finite}};
  }
  const Json json = {{"file", input.path()},
                     {"width", frame.width},
                     {"height", frame.height},
                     {"data_window", input.data_window()},
                     {"schema", input.schema()},
                     {"view", input.view()},
                     {"views", input.views()},
                     {"samples", samples_json(frame)},
                     {"invalid_pixels", report.invalid_pixels},
                     {"bad_feature_pixels", bad_features},
                     {"channels", channels},
                     {"planes", planes},
                     {"missing", input.missing()},
                     {"assumed", input.assumptions()}};
  std::printf("%s\n", json.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
}

void info(const InfoOptions& options) {
  exr::ReadOptions read{.layers = {"all"}, .require_variance = false};
  apply(options.samples, read);
  apply(options.mapping, read);
  const exr::LoadedFrame input = exr::read_frame(options.input, read);
  const FrameReport report = input.frame().colour_variance[0] ? inspect(input.frame()) : FrameReport{};
  options.json ? print_json(input, report) : print_text(input, report);
}

}  // namespace

Action add_info(CLI::App& verb) {
  auto options = std::make_shared<InfoOptions>();
  verb.add_option("FILE", options->input, "OpenEXR file")->required();
  declare(verb, options->samples);
  declare(verb, options->mapping);
  verb.add_flag("--json", options->json, "Print JSON");
  verb.footer(kInfoFooter);
  return [options] { info(*options); };
}

}  // namespace stein::cli
