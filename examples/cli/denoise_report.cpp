// SPDX-License-Identifier: Apache-2.0
#include "denoise_report.hpp"

#include <sys/resource.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "frame_text.hpp"

namespace stein::cli {
namespace {

std::int64_t peak_memory_bytes() {
  struct rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

void print_line(const char* label, const std::string& text) { std::printf("%-9s %s\n", label, text.c_str()); }

void print_mapping(const exr::LoadedFrame& input) {
  const Frame& frame = input.frame();
  print_line("colour", colour_text(frame));
  for (const Feature& feature : frame.features) {
    print_line("feature", feature_text(feature));
  }
  std::size_t unused = 0;
  for (const exr::ChannelInfo& channel : input.channels()) {
    unused += channel.role.empty() ? 1 : 0;
  }
  for (const Layer& layer : frame.layers) {
    print_line("layer", layer.name + ", filtered as the colour is");
  }
  if (unused > 0) {
    print_line("carried", std::to_string(unused) + " other channels, as they are");
  }
  for (const std::string& text : input.missing()) {
    print_line("missing", text);
  }
  for (const std::string& text : input.assumptions()) {
    print_line("assumed", text);
  }
}

void print_repairs(const DenoiseSummary& summary) {
  const FrameReport& counts = summary.report.frame;
  std::printf("%-9s %lld invalid pixels\n", "repaired", static_cast<long long>(counts.invalid_pixels));
  std::printf("%-9s %lld outliers scaled down, %.2f %% of the image's energy\n", "",
              static_cast<long long>(summary.report.outlier_pixels), 100 * summary.report.outlier_energy);
  const std::vector<Feature>& features = summary.input.frame().features;
  for (std::size_t i = 0; i < counts.bad_feature_pixels.size() && i < features.size(); ++i) {
    if (counts.bad_feature_pixels[i] > 0) {
      std::printf("%-9s %lld pixels without a usable %s\n", "", static_cast<long long>(counts.bad_feature_pixels[i]),
                  features[i].name.c_str());
    }
  }
  const std::vector<Layer>& layers = summary.input.frame().layers;
  for (std::size_t i = 0; i < counts.bad_layer_pixels.size() && i < layers.size(); ++i) {
    if (counts.bad_layer_pixels[i] > 0) {
      std::printf("%-9s %lld pixels without a usable layer %s\n", "",
                  static_cast<long long>(counts.bad_layer_pixels[i]), layers[i].name.c_str());
    }
  }
}

nlohmann::ordered_json seconds_json(const DenoiseSummary& summary) {
  nlohmann::ordered_json stages = nlohmann::ordered_json::object();
  for (const StageSeconds& stage : summary.report.stages) {
    stages[stage.name] = stage.seconds;
  }
  const Seconds& seconds = summary.seconds;
  return {{"read", seconds.read},
          {"compute", seconds.compute},
          {"write", seconds.write},
          {"total", seconds.total},
          {"stages", stages}};
}

nlohmann::ordered_json bad_features_json(const DenoiseSummary& summary) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  const std::vector<std::int64_t>& counts = summary.report.frame.bad_feature_pixels;
  const std::vector<Feature>& features = summary.input.frame().features;
  for (std::size_t i = 0; i < counts.size() && i < features.size(); ++i) {
    json[features[i].name] = counts[i];
  }
  return json;
}

/// By name: the pixels that had to be filled.
nlohmann::ordered_json layers_json(const DenoiseSummary& summary) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  const std::vector<std::int64_t>& counts = summary.report.frame.bad_layer_pixels;
  const std::vector<Layer>& layers = summary.input.frame().layers;
  for (std::size_t i = 0; i < counts.size() && i < layers.size(); ++i) {
    json[layers[i].name] = {{"bad_pixels", counts[i]}};
  }
  return json;
}

nlohmann::ordered_json choice_json(const DenoiseReport& report) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < report.choice_share.size() && i < report.candidates.size(); ++i) {
    json[report.candidates[i]] = report.choice_share[i];
  }
  return json;
}

nlohmann::ordered_json filters_json(const DenoiseReport& report) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const FilterShare& filter : report.filters) {
    nlohmann::ordered_json entry = {{"name", filter.name}, {"weight", filter.weight}};
    if (filter.mean_relative_error) entry["mean_estimated_relative_error"] = *filter.mean_relative_error;
    entry["risk"] = filter.risk;
    entry["risk_reason"] = filter.risk_reason;
    json.push_back(std::move(entry));
  }
  return json;
}

void print_filters(const DenoiseReport& report) {
  for (const FilterShare& filter : report.filters) {
    std::printf("%-9s %5.1f %% %s, %s: %s\n", &filter == report.filters.data() ? "filter" : "", 100 * filter.weight,
                filter.name.c_str(), filter.risk.c_str(), filter.risk_reason.c_str());
  }
}

void print_errors(const DenoiseReport& report) {
  constexpr double kClearWeight = 0.01;  // below it an error of a picture alone is a lower bound in most of the image
  std::printf("%-9s mean squared error %.4g %.4g %.4g (R G B), relative %.4g\n", "estimated", report.mean_error[0],
              report.mean_error[1], report.mean_error[2], report.mean_relative_error);
  if (report.filters.size() < 2) return;
  for (const FilterShare& filter : report.filters) {
    if (!filter.mean_relative_error) continue;
    std::printf("%-9s relative %s%.4g of %s alone\n", "", filter.weight > kClearWeight ? "" : "at least ",
                *filter.mean_relative_error, filter.name.c_str());
  }
}

}  // namespace

void print_memory(std::int64_t scratch_bytes) {
  constexpr double kMiB = 1024.0 * 1024.0;
  std::printf("%-9s %.0f MiB at most", "memory", static_cast<double>(peak_memory_bytes()) / kMiB);
  if (scratch_bytes > 0) std::printf(", %.0f MiB in scratch files", static_cast<double>(scratch_bytes) / kMiB);
  std::printf("\n");
}

void warn_if_exceeded(const Memory& memory, std::vector<std::string>& warnings) {
  const std::int64_t held = peak_memory_bytes();
  if (held <= memory.limit().bytes) return;
  warnings.push_back("the process held " + std::to_string(held) + " bytes, more than the " +
                     std::to_string(memory.limit().bytes) +
                     " of --max-memory: threads, rows of the file and windows need more; allow more, or take "
                     "fewer threads");
}

void print_warnings(const std::string& path, const DenoiseReport& report) {
  for (const std::string& warning : report.warnings) {
    std::fprintf(stderr, "stein: warning: '%s': %s\n", path.c_str(), warning.c_str());
  }
}

void print_line_of_frame(const DenoiseSummary& summary) {
  std::printf("frame %-5d %s, %.2f s, estimated relative error %.4g\n", summary.frame.value_or(0),
              summary.output_path.c_str(), summary.seconds.total, summary.report.mean_relative_error);
  std::fflush(stdout);  // a log is looked at while the range runs
}

void print_summary(const DenoiseSummary& summary) {
  const DenoiseReport& report = summary.report;
  print_line("input", summary.input.path() + ", " + size_text(summary.input));
  if (!summary.input.view().empty()) print_line("view", summary.input.view());
  print_line("samples", samples_text(summary.input.frame()));
  print_line("schema", summary.input.schema());
  print_mapping(summary.input);
  print_repairs(summary);
  print_filters(report);
  for (std::size_t i = 0; i < report.choice_share.size() && i < report.candidates.size(); ++i) {
    std::printf("%-9s %5.1f %% %s\n", i == 0 ? "choice" : "", 100 * report.choice_share[i],
                report.candidates[i].c_str());
  }
  print_errors(report);
  const Seconds& seconds = summary.seconds;
  std::printf("%-9s %.2f s: read %.2f, compute %.2f, write %.2f\n", "time", seconds.total, seconds.read,
              seconds.compute, seconds.write);
  print_memory(report.scratch_bytes);
  print_line("output", summary.output_path);
}

nlohmann::ordered_json to_json(const DenoiseSummary& summary) {
  const DenoiseReport& report = summary.report;
  const Frame& frame = summary.input.frame();
  nlohmann::ordered_json json = {{"version", STEIN_VERSION}};
  if (summary.frame) json["frame"] = *summary.frame;
  if (!summary.input.view().empty()) json["view"] = summary.input.view();
  json.update({{"input", summary.input.path()},
               {"output", summary.output_path},
               {"width", frame.width},
               {"height", frame.height},
               {"filter", summary.filter},
               {"filters", filters_json(report)},
               {"threads", summary.threads},
               {"instruction_set", report.instruction_set},
               {"seconds", seconds_json(summary)},
               {"peak_memory_bytes", peak_memory_bytes()},
               {"scratch_bytes", report.scratch_bytes},
               {"invalid_pixels", report.frame.invalid_pixels},
               {"outlier_pixels", report.outlier_pixels},
               {"outlier_energy", report.outlier_energy},
               {"bad_feature_pixels", bad_features_json(summary)},
               {"layers", layers_json(summary)},
               {"mean_estimated_error", report.mean_error},
               {"mean_estimated_relative_error", report.mean_relative_error},
               {"choice_share", choice_json(report)},
               {"schema", summary.input.schema()},
               {"missing", summary.input.missing()},
               {"assumed", summary.input.assumptions()},
               {"warnings", report.warnings}});
  return json;
}

nlohmann::ordered_json to_json(const std::vector<DenoiseSummary>& views) {
  if (views.size() == 1) return to_json(views.front());
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const DenoiseSummary& view : views) list.push_back(to_json(view));
  return {{"version", STEIN_VERSION}, {"views", list}};
}

}  // namespace stein::cli
