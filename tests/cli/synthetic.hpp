// SPDX-License-Identifier: Apache-2.0
//
// Small images made in code.
#pragma once

#include <map>
#include <string>
#include <vector>

/// Named float channels of one size, row-major.
struct Channels {
  int width = 0;
  int height = 0;
  std::map<std::string, std::vector<float>> values;

  [[nodiscard]] float& at(const std::string& name, int x, int y);
};

/// A noisy image of the native schema: colour, normal and albedo with variances, sampleCount 8, and a channel "id.Z"
/// that stein does not know.
[[nodiscard]] Channels noisy_image(int width, int height, unsigned seed = 7);

/// R, G, B of one value.
[[nodiscard]] Channels flat_image(int width, int height, float value);

void write(const std::string& path, const Channels& image);
[[nodiscard]] bool has_channel(const std::string& path, const std::string& name);
[[nodiscard]] std::vector<float> read_channel(const std::string& path, const std::string& name);
