// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace stein::cli {

/// Throws stein::Error on failure.
using Action = std::function<void()>;

/// Parses the arguments that `declare` declares, then calls the action that it returned. What goes wrong becomes a
/// message after the program's name on stderr, and an exit code (exit_codes.hpp). Returns that for `main`.
[[nodiscard]] int run_program(const char* name, const char* description, int argc, char** argv,
                              const std::function<Action(CLI::App&)>& declare) noexcept;

}  // namespace stein::cli
