// SPDX-License-Identifier: Apache-2.0
//
// How the channels of one file are understood: by which schema, and by what the caller says.
#pragma once

#include <string>
#include <vector>

#include "exr/schema.hpp"
#include "exr/source_file.hpp"

namespace stein::exr {

struct Mapping {
  const Schema* schema = &native_schema();
  Bindings bindings;
  std::vector<PlaneMap> maps;                      ///< these first
  VarianceOf variance_of = VarianceOf::kAsStated;  ///< of all variances, against the schema
  std::vector<Companion> companions = {};
  std::string view = {};  ///< empty: the default one
};

/// Looks into the file at `path` and beside it. The native schema where no other fits and `preset` is empty.
/// @throws Error kIo; kInvalidArgument for a preset that is unknown or that cannot be of this file, and for a view that
/// it lacks.
[[nodiscard]] Mapping find_mapping(const std::string& path, const std::string& preset = {},
                                   const std::string& view = {});

}  // namespace stein::exr
