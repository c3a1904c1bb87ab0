// SPDX-License-Identifier: Apache-2.0
//
// Files of several views, such as the two eyes of a stereo pair.
#pragma once

#include <string>
#include <vector>

#include "exr/source_file.hpp"

namespace stein::exr {

/// As the attribute multiView of a single part names them, or the attributes view of several; the first is the default
/// view. Empty: the file has none.
[[nodiscard]] std::vector<std::string> list_views(const SourceFile& file);

/// Each channel's name without its view, "right.R" being R; empty for those of other views. An empty `view` is the
/// default view. In a single part a channel belongs to the view that its last name but one says, else to the default.
/// @throws Error kInvalidArgument for a view that the file does not have.
[[nodiscard]] std::vector<std::string> names_in_view(const SourceFile& file, const std::string& view);

/// A new channel's name in the part: "error.R" of the view right is error.right.R where the part has several views.
[[nodiscard]] std::string name_for_view(const SourceFile& file, int part, const std::string& view,
                                        const std::string& name);

}  // namespace stein::exr
