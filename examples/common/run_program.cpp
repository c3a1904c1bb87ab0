// SPDX-License-Identifier: Apache-2.0
#include "run_program.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <string>

#include "exit_codes.hpp"

namespace stein::cli {
namespace {

int fail(const char* name, int code, const char* message) {
  std::fprintf(stderr, "%s: %s\n", name, message);
  return code;
}

int parse_and_run(const char* name, CLI::App& app, int argc, char** argv, const Action& action) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help, --version
    return app.exit(request);
  } catch (const CLI::ParseError& error) {
    return fail(name, kUsage, (std::string(error.what()) + " (see '" + name + " --help')").c_str());
  }
  action();
  return kSuccess;
}

}  // namespace

int run_program(const char* name, const char* description, int argc, char** argv,
                const std::function<Action(CLI::App&)>& declare) noexcept {
  try {
    CLI::App app(description, name);
    const Action action = declare(app);
    return parse_and_run(name, app, argc, argv, action);
  } catch (...) {
    const Failure failure = current_failure();
    return fail(name, failure.code(), failure.what());
  }
}

}  // namespace stein::cli
