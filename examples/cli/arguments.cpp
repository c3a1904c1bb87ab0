// SPDX-License-Identifier: Apache-2.0
#include "arguments.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "parsing.hpp"

namespace stein::cli {
namespace {

constexpr const char* kMapOption = "--map";
constexpr const char* kMapForm = "PLANE=CHANNELS[:var=CHANNELS], such as albedo=Diffuse.R,G,B:var=DiffuseVar.R,G,B";

/// "Diffuse.R,G,B" is Diffuse.R, Diffuse.G, Diffuse.B.
std::vector<std::string> channel_list(const std::string& option_text, std::string_view list) {
  std::vector<std::string> names;
  std::string layer;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string name(list.substr(begin, end - begin));
    if (name.empty()) fail_argument(kMapOption, option_text, kMapForm);
    const std::size_t dot = name.rfind('.');
    names.push_back(dot == std::string::npos ? layer + name : name);
    if (dot != std::string::npos) layer = name.substr(0, dot + 1);
    begin = end + 1;
  }
  return names;
}

}  // namespace

std::pair<double, double> parse_range(const std::string& text) {
  std::string_view low_text;
  std::string_view high_text;
  double low = 0;
  double high = 0;
  if (!split(text, ',', low_text, high_text) || !parse_number(low_text, low) || !parse_number(high_text, high) ||
      !std::isfinite(low) || !std::isfinite(high) || low >= high) {
    fail_argument("--range", text, "LOW,HIGH with LOW < HIGH, such as 0,0.5");
  }
  return {low, high};
}

FeatureSigma parse_feature_sigma(const std::string& text) {
  std::string_view name;
  std::string_view value;
  FeatureSigma result;
  if (!split(text, '=', name, value) || name.empty() || !parse_number(value, result.sigma)) {
    fail_argument("--feature-sigma", text, "NAME=VALUE, such as normal=0.8");
  }
  result.name = name;
  return result;
}

exr::PlaneMap parse_plane_map(const std::string& text) {
  constexpr std::string_view kVariance = ":var=";
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos) fail_argument(kMapOption, text, kMapForm);
  exr::PlaneMap map;
  map.plane = text.substr(0, equals) == "color" ? "colour" : text.substr(0, equals);
  const std::string_view channels = std::string_view(text).substr(equals + 1);
  const std::size_t variance = channels.find(kVariance);
  map.mean = channel_list(text, channels.substr(0, variance));
  if (variance != std::string_view::npos) {
    map.variance = channel_list(text, channels.substr(variance + kVariance.size()));
  }
  return map;
}

}  // namespace stein::cli
