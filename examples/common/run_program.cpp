// SPDX-License-Identifier: Apache-2.0
#include "run_program.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "exit_codes.hpp"
#include "stein/error.hpp"

namespace stein::cli {

int run_program(CLI::App& app, int argc, char** argv, const std::function<void()>& action) {
  const std::string name = app.get_name();
  const auto fail = [&name](int code, const std::string& message) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), message.c_str());
    return code;
  };
  try {
    app.parse(argc, argv);
    action();
    return kSuccess;
  } catch (const CLI::Success& request) {  // --help, --version
    return app.exit(request);
  } catch (const CLI::ParseError& error) {
    return fail(kUsage, std::string(error.what()) + " (see '" + name + " --help')");
  } catch (const Error& error) {
    return fail(exit_code(error.code()), error.code() == ErrorCode::kCancelled ? "cancelled" : error.what());
  } catch (const std::bad_alloc&) {
    return fail(kOtherFailure, "out of memory");
  } catch (const std::exception& error) {
    return fail(kOtherFailure, error.what());
  }
}

}  // namespace stein::cli
