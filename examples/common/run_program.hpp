// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace stein::cli {

/// Parses the arguments, then calls `action`. What goes wrong becomes a message after the program's name on stderr, and
/// an exit code (exit_codes.hpp). Returns that for `main`.
[[nodiscard]] int run_program(CLI::App& app, int argc, char** argv, const std::function<void()>& action);

}  // namespace stein::cli
