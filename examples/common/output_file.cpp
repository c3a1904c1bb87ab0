// SPDX-License-Identifier: Apache-2.0
#include "output_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <system_error>

#include "stein/error.hpp"

namespace stein::cli {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const std::string& reason) {
  throw Error(ErrorCode::kIo, "cannot write '" + path + "': " + reason);
}

[[noreturn]] void fail_with_errno(const std::string& path) { fail(path, std::generic_category().message(errno)); }

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
  std::error_code error;
  if (std::filesystem::equivalent(input, path, error)) {
    throw Error(ErrorCode::kInvalidArgument, "-o " + path + " is the input itself: choose another file");
  }
  check_output_path(path);
}

void write_whole_file(const std::string& path, std::string_view content) {
  std::error_code error;
  const bool is_special = fs::exists(path, error) && !fs::is_regular_file(path, error);
  // A link is kept, and what it points to is replaced.
  const fs::path target = fs::is_symlink(path, error) ? fs::weakly_canonical(path, error) : fs::path(path);
  const std::string name = is_special ? path : target.string() + "." + std::to_string(getpid()) + ".tmp";
  const int flags = is_special ? O_WRONLY : O_WRONLY | O_CREAT | O_EXCL;
  const int file = open(name.c_str(), flags | O_CLOEXEC, 0666);
  if (file < 0) {
    fail_with_errno(path);
  }
  const bool written = write_and_close(file, content);
  if (written && (is_special || rename(name.c_str(), target.c_str()) == 0)) {
    return;
  }
  const int failure = errno;
  if (!is_special) {
    unlink(name.c_str());
  }
  errno = failure;
  fail_with_errno(path);
}

}  // namespace stein::cli
