// SPDX-License-Identifier: Apache-2.0
//
// Files with one mistake each, for the tests of messages.
#pragma once

#include <string>

/// Writes them all into the folder.
void write_bad_files(const std::string& folder);
