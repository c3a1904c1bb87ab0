// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfDeepScanLineInputPart.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "exr/deep_row.hpp"
#include "exr/source_file.hpp"
#include "stein/exr_samples.hpp"

namespace stein::exr {

struct SampleReader::Data {
  explicit Data(const std::string& path);

  /// Reads the bytes of a row as they are.
  void read_chunk(int y);

  [[nodiscard]] const Imf::Header& header() const { return file.header(part); }

  SourceFile file;
  int part;
  std::vector<SampleLayer> layers;
  std::vector<std::string> channels;
  DeepRow row;
  std::vector<std::size_t> selection;  // of the row's channels, in the order of `channels`
  std::optional<Imf::DeepScanLineInputPart> input;
  std::vector<char> chunk;
  int rows_read = 0;
};

}  // namespace stein::exr
