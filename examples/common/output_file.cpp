// SPDX-License-Identifier: Apache-2.0
#include "output_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <system_error>

#include "stein/error.hpp"
#include "stein/exr.hpp"

namespace stein::cli {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const std::string& reason, int system_error = 0) {
  throw Error(ErrorCode::kIo, "cannot write '" + path + "': " + reason, system_error);
}

[[noreturn]] void fail_with_errno(const std::string& path) {
  fail(path, std::generic_category().message(errno), errno);
}

bool write_all(int file, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = write(file, content.data(), content.size());
    if (written < 0 && errno != EINTR) {
      return false;
    }
    if (written > 0) {
      content.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  return true;
}

bool write_and_close(int file, std::string_view content) {
  const bool written = write_all(file, content);
  const int write_errno = errno;
  const bool closed = close(file) == 0;
  if (!written) {
    errno = write_errno;
  }
  return written && closed;
}

}  // namespace

bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) || fs::weakly_canonical(a, error) == fs::weakly_canonical(b, error);
}

void check_output_path(const std::string& path) {
  std::error_code ignored;
  const fs::path folder = fs::absolute(path, ignored).parent_path();
  if (fs::is_directory(path, ignored)) {
    fail(path, "it is a folder");
  }
  if (!fs::is_directory(folder, ignored)) {
    fail(path, "there is no folder '" + folder.string() + "'");
  }
  if (access(folder.c_str(), W_OK) != 0) {
    fail(path, "the folder '" + folder.string() + "' is not writable");
  }
}

void check_output_path(const std::string& path, const std::string& input) {
  if (is_same_file(input, path)) {
    throw Error(ErrorCode::kInvalidArgument, "-o " + path + " is the input itself: choose another file");
  }
  check_output_path(path);
}

void write_whole_file(const std::string& path, std::string_view content) {
  std::error_code error;
  if (!fs::exists(path, error) || fs::is_regular_file(path, error)) {
    exr::write_bytes(path, content);
    return;
  }
  const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0 || !write_and_close(file, content)) {
    fail_with_errno(path);
  }
}

}  // namespace stein::cli
