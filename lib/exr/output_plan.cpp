// SPDX-License-Identifier: Apache-2.0
#include "exr/output_plan.hpp"

#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfPartType.h>

#include <algorithm>
#include <string_view>

namespace stein::exr {
namespace {

bool is_lossy(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
    case Imf::RLE_COMPRESSION:
    case Imf::ZIPS_COMPRESSION:
    case Imf::ZIP_COMPRESSION:
    case Imf::PIZ_COMPRESSION:
      return false;
    default:
      return true;
  }
}

bool is_carried(Role role, const OutputRules& rules) {
  if (rules.keep_all) return true;
  switch (role) {
    case Role::kColour:
    case Role::kEarlierResult:
      return false;
    case Role::kColourVariance:
    case Role::kColourCovariance:
    case Role::kFeatureVariance:
    case Role::kFeatureCovariance:
    case Role::kSampleCount:
    case Role::kNoise:
      return rules.keep_inputs;
    case Role::kFeatureMean:
      return !rules.replace_frame;
    case Role::kNoisyColour:
      return !rules.replace_noisy;
    default:
      return true;
  }
}

bool is_new(const OutputRules& rules, int part, const std::string& name) {
  return std::any_of(rules.new_channels.begin(), rules.new_channels.end(),
                     [&](const NewChannel& channel) { return channel.part == part && channel.name == name; });
}

bool speaks_of_storage(std::string_view attribute, bool is_deep) {
  if (attribute == "channels" || attribute == "chunkCount" || attribute == "tiles") return true;
  // Elsewhere these names are free.
  return is_deep && (attribute == "version" || attribute == "maxSamplesPerPixel" || attribute == "deepImageState");
}

bool speaks_of_samples(std::string_view attribute) {
  return attribute == kSamplesPerPixel || attribute == kDegreesOfFreedom;
}

}  // namespace

Imf::Header scanline_header(const Imf::Header& source, bool keep_samples) {
  const bool is_deep = source.hasType() && Imf::isDeepData(source.type());
  Imf::Header header;
  for (auto it = source.begin(); it != source.end(); ++it) {
    const std::string name = it.name();
    if (speaks_of_storage(name, is_deep) || (!keep_samples && speaks_of_samples(name))) continue;
    header.insert(name, it.attribute());
  }
  header.setType(Imf::SCANLINEIMAGE);
  header.lineOrder() = Imf::INCREASING_Y;
  if (is_lossy(header.compression())) header.compression() = Imf::ZIP_COMPRESSION;
  return header;
}

std::vector<PartPlan> plan_output(const SourceFile& source, const std::vector<Role>& roles, const OutputRules& rules) {
  std::vector<PartPlan> plan;
  for (int part = 0; part < source.parts() && source.is_own(part); ++part) {
    const bool has_new = std::any_of(rules.new_channels.begin(), rules.new_channels.end(),
                                     [&](const NewChannel& channel) { return channel.part == part; });
    PartPlan next{part, !has_new, source.header(part), {}};
    for (std::size_t i = 0; i < source.channels().size(); ++i) {
      const SourceChannel& channel = source.channels()[i];
      if (channel.part != part) continue;
      if (is_carried(roles[i], rules) && !is_new(rules, part, channel.name)) {
        next.carried.push_back(channel.name);
      } else {
        next.copied = false;
      }
    }
    if (!has_new && next.carried.empty() && !next.copied) continue;
    if (!next.copied) {
      const Imf::ChannelList& from = source.header(part).channels();
      next.header = scanline_header(source.header(part), !rules.replace_frame);
      for (const std::string& name : next.carried) next.header.channels().insert(name, from[name]);
    }
    for (const NewChannel& channel : rules.new_channels) {
      if (channel.part == part) next.header.channels().insert(channel.name, Imf::Channel(channel.type));
    }
    plan.push_back(std::move(next));
  }
  return plan;
}

}  // namespace stein::exr
