// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <utility>

#include "stein/error.hpp"
#include "stein/exr_samples.hpp"

namespace stein::exr {

SampleSource sample_source(SampleReader& reader) {
  SampleSource source{reader.width(), reader.height(), {}, {}};
  std::vector<std::string> channels;
  for (const SampleLayer& layer : reader.layers()) {
    if (layer.kind == SampleLayer::Kind::kOther) continue;
    channels.insert(channels.end(), layer.channels.begin(), layer.channels.end());
    if (layer.kind == SampleLayer::Kind::kColour) continue;
    const bool is_random = layer.kind == SampleLayer::Kind::kRandom;
    source.groups.push_back({is_random ? SampleGroup::Kind::kRandom : SampleGroup::Kind::kFeature, layer.name,
                             static_cast<int>(layer.channels.size())});
  }
  reader.select(channels);
  source.next_row = [&reader](std::vector<std::uint32_t>& counts, std::vector<float>& samples) {
    if (!reader.read_row(counts, samples)) {
      throw Error(ErrorCode::kInvalidArgument, "'" + reader.path() + "': all of its rows have been read already");
    }
  };
  return source;
}

}  // namespace stein::exr
