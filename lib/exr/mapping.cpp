// SPDX-License-Identifier: Apache-2.0
#include "exr/mapping.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "exr/layout.hpp"
#include "exr/views.hpp"

namespace stein::exr {
namespace {

/// Whether one of a pattern's alternatives matches a channel; fills bindings that are still open.
bool bind(std::string_view alternatives, const std::vector<std::string>& names, Bindings& bindings) {
  while (!alternatives.empty()) {
    const std::size_t end = std::min(alternatives.find('|'), alternatives.size());
    for (const std::string& name : names) {
      if (const auto found = match_pattern(alternatives.substr(0, end), name, bindings)) {
        bindings = found->bindings;
        return true;
      }
    }
    alternatives.remove_prefix(std::min(end + 1, alternatives.size()));
  }
  return false;
}

/// `is_chosen`: by the caller, so that only what names must be known for is asked.
std::optional<Bindings> recognise(const SourceFile& file, const Schema& schema, const std::string& view,
                                  bool is_chosen) {
  const std::vector<std::string> names = name_channels(file, schema, names_in_view(file, view)).full;
  Bindings bindings;
  for (const std::string_view pattern : schema.signature) {
    const bool is_needed = !is_chosen || pattern.find("<layer>") != std::string_view::npos;
    if (is_needed && !bind(pattern, names, bindings)) return std::nullopt;
  }
  return bindings;
}

/// Files whose names differ in the ending only, for schemas of one file per buffer.
std::vector<Companion> companions_of(const std::string& path, const Schema& schema) {
  std::vector<Companion> found;
  if (schema.companions.empty()) return found;
  const std::filesystem::path file(path);
  const std::string stem = file.stem().string();
  const std::string_view ending = schema.companions.front();
  if (stem.size() < ending.size() || stem.substr(stem.size() - ending.size()) != ending) return found;
  const std::string shared = stem.substr(0, stem.size() - ending.size());
  for (const std::string_view name : schema.companions.subspan(1)) {
    std::filesystem::path beside = file;
    beside.replace_filename(shared + std::string(name) + file.extension().string());
    std::error_code error;
    if (std::filesystem::is_regular_file(beside, error)) found.push_back({beside.string(), std::string(name)});
  }
  return found;
}

std::optional<Mapping> try_schema(const SourceFile& alone, const Schema& schema, const std::string& view,
                                  bool is_chosen) {
  Mapping mapping;
  mapping.view = view;
  mapping.schema = &schema;
  mapping.companions = companions_of(alone.path(), schema);
  const bool is_one_of_many = !schema.companions.empty();
  if (is_one_of_many && mapping.companions.empty()) return std::nullopt;
  const auto bindings = is_one_of_many
                            ? recognise(SourceFile(alone.path(), mapping.companions), schema, view, is_chosen)
                            : recognise(alone, schema, view, is_chosen);
  if (!bindings) return std::nullopt;
  mapping.bindings = *bindings;
  return mapping;
}

}  // namespace

Mapping find_mapping(const std::string& path, const std::string& preset, const std::string& view) {
  const SourceFile file(path);
  if (preset.empty()) {
    for (const Schema& schema : schemas()) {
      if (auto mapping = try_schema(file, schema, view, false)) return *mapping;
    }
    Mapping native;
    native.view = view;
    return native;
  }
  const std::vector<const Schema*> candidates = schemas_named(preset);
  for (const bool is_chosen : {false, true}) {
    for (const Schema* schema : candidates) {
      if (auto mapping = try_schema(file, *schema, view, is_chosen)) return *mapping;
    }
  }
  const Schema& first = *candidates.front();
  throw Error(ErrorCode::kInvalidArgument,
              "'" + path + "' cannot be read with the preset " + preset + ": " +
                  (first.companions.empty() ? "no channel is named like " + std::string(first.signature.back())
                                            : "its name does not end in " + std::string(first.companions.front()) +
                                                  ".exr, or the files beside it are missing"));
}

}  // namespace stein::exr
