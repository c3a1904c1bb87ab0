// SPDX-License-Identifier: Apache-2.0
//
// Parts: which one holds the colour, and what the channels of the others are called in full.
#include <algorithm>

#include "exr/layout.hpp"

namespace stein::exr {
namespace {

using Names = std::vector<std::string>;  // per channel of the file

bool has_channel(const SourceFile& file, const Names& own, int part, const char* name) {
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (file.channels()[i].part == part && own[i] == name) return true;
  }
  return false;
}

bool has_rgb(const SourceFile& file, const Names& own, int part) {
  return has_channel(file, own, part, "R") && has_channel(file, own, part, "G") && has_channel(file, own, part, "B");
}

/// Whether a part of this name is one layer of the schema, such as "albedo", "albedo.variance" or "covariance".
bool is_layer(const Schema& schema, const std::string& part_name) {
  if (part_name.empty()) return false;
  const std::string below = part_name + ".";
  const bool is_prefix = std::any_of(schema.entries.begin(), schema.entries.end(), [&](const SchemaEntry& entry) {
    return entry.pattern.substr(0, below.size()) == below;
  });
  const auto found = match(schema, below + "R");
  return is_prefix || (found && (found->entry->role != Role::kFeatureMean || schema.knows_feature(found->feature)));
}

/// A part's channels belong below its name if some of them have no layer of their own, as in a part "albedo" with R, G,
/// B; a part that only groups layers, such as "features" with albedo.R, adds nothing to their names.
bool qualifies(const SourceFile& file, const Schema& schema, int part) {
  const std::string name = file.part_name(part);
  if (name.empty()) return false;
  if (is_layer(schema, name)) return true;
  return std::any_of(file.channels().begin(), file.channels().end(), [&](const SourceChannel& channel) {
    return channel.part == part && channel.name.find('.') == std::string::npos && channel.name != "sampleCount";
  });
}

/// By the habit of keeping R, G and B without a layer.
int part_with_rgb(const SourceFile& file, const Schema& schema, const Names& own) {
  int found = -1;
  int rank_found = 0;
  for (int part = 0; part < file.parts() && file.is_own(part); ++part) {
    if (!has_rgb(file, own, part) || (file.parts() > 1 && is_layer(schema, file.part_name(part)))) continue;
    const bool usual =
        std::find(schema.main_parts.begin(), schema.main_parts.end(), file.part_name(part)) != schema.main_parts.end();
    const int rank = (file.is_deep(part) ? 1 : 3) + (usual ? 1 : 0);
    if (rank > rank_found) {
      found = part;
      rank_found = rank;
    }
  }
  return found;
}

Names full_names(const SourceFile& file, const Schema& schema, const Names& own, int main_part) {
  std::vector<char> qualified(static_cast<std::size_t>(file.parts()));
  for (int part = 0; part < file.parts(); ++part) {
    qualified[static_cast<std::size_t>(part)] = file.parts() > 1 && part != main_part && qualifies(file, schema, part);
  }
  Names names;
  names.reserve(own.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    const int part = file.channels()[i].part;
    const std::string above = file.part_name(part) + ".";
    const bool as_it_is = own[i].empty() || qualified[static_cast<std::size_t>(part)] == 0 || own[i] == "sampleCount" ||
                          own[i].rfind(above, 0) == 0;
    names.push_back(as_it_is ? own[i] : above + own[i]);
  }
  return names;
}

bool is_colour(const std::optional<Match>& found) { return found && found->entry->role == Role::kColour; }

/// Under the schema's own names of the colour.
int part_with_colour(const SourceFile& file, const Schema& schema, const std::vector<std::string>& full) {
  std::vector<unsigned> seen(static_cast<std::size_t>(file.parts()));  // a bit for each of R, G, B
  for (std::size_t i = 0; i < full.size(); ++i) {
    const int part = file.channels()[i].part;
    const auto found = match(schema, full[i]);
    if (!file.is_own(part) || !is_colour(found)) continue;
    unsigned& colours = seen[static_cast<std::size_t>(part)];
    colours |= 1U << static_cast<unsigned>(found->colours[0]);
    if (colours == 7) return part;
  }
  return -1;
}

}  // namespace

ChannelNames name_channels(const SourceFile& file, const Schema& schema, const std::vector<std::string>& own) {
  ChannelNames names;
  if (is_colour(match(schema, "R"))) names.main_part = part_with_rgb(file, schema, own);
  names.full = full_names(file, schema, own, names.main_part);
  if (names.main_part < 0) names.main_part = part_with_colour(file, schema, names.full);
  return names;
}

}  // namespace stein::exr
