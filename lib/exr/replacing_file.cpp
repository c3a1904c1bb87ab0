// SPDX-License-Identifier: Apache-2.0
#include "exr/replacing_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <random>
#include <string_view>
#include <system_error>
#include <utility>

#include "stein/error.hpp"

namespace stein::exr {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, int error) {
  throw Error(ErrorCode::kIo, "cannot write '" + path + "': " + std::generic_category().message(error));
}

std::string random_name() {
  std::random_device entropy;
  constexpr std::string_view kDigits = "0123456789abcdefghijklmnopqrstuv";
  std::string name = ".stein-";
  for (int i = 0; i < 12; ++i) name += kDigits[entropy() % kDigits.size()];
  return name + ".tmp";
}

/// So that the rename itself outlives a power cut. Not every file system can: the file is complete either way.
void sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

class ReplacingFile::Stream : public Imf::OStream {
 public:
  Stream(int descriptor, const std::string& path)
      : OStream(path.c_str()), path_(path), file_(::fdopen(descriptor, "wb")) {
    if (file_ == nullptr) {
      const int error = errno;
      ::close(descriptor);
      fail(path_, error);
    }
  }
  ~Stream() override {
    if (file_ != nullptr) std::fclose(file_);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  void write(const char* bytes, int count) override {
    const auto size = static_cast<std::size_t>(count);
    if (std::fwrite(bytes, 1, size, file_) != size) remember_and_fail();
  }
  std::uint64_t tellp() override {
    const off_t at = ::ftello(file_);
    if (at < 0) remember_and_fail();
    return static_cast<std::uint64_t>(at);
  }
  void seekp(std::uint64_t position) override {
    if (::fseeko(file_, static_cast<off_t>(position), SEEK_SET) != 0) remember_and_fail();
  }

  /// To the disk, then closed.
  void finish() {
    if (error_ != 0) fail(path_, error_);
    if (std::fflush(file_) != 0 || ::fsync(::fileno(file_)) != 0) remember_and_fail();
    std::FILE* file = std::exchange(file_, nullptr);
    if (std::fclose(file) != 0) fail(path_, errno);
  }

 private:
  [[noreturn]] void remember_and_fail() {
    error_ = errno != 0 ? errno : EIO;
    fail(path_, error_);
  }

  std::string path_;
  std::FILE* file_;
  int error_ = 0;
};

ReplacingFile::ReplacingFile(const std::string& path) : path_(path), target_(path) {
  std::error_code error;
  if (fs::symlink_status(path, error).type() == fs::file_type::symlink) {
    target_ = fs::canonical(path, error).string();
    if (error) fail(path, error.value());
  }
  const fs::file_status status = fs::status(target_, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw Error(ErrorCode::kIo, "cannot write '" + path + "': it exists and is not a regular file");
  }
  open_temporary();
}

void ReplacingFile::open_temporary() {
  const fs::path folder = fs::path(target_).parent_path();
  constexpr mode_t kReadWriteAll = 0666;  // the caller's umask takes away from it
  int descriptor = -1;
  for (int attempt = 0; descriptor < 0 && attempt < 100; ++attempt) {
    temporary_ = (folder / random_name()).string();
    descriptor = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kReadWriteAll);
    if (descriptor < 0 && errno != EEXIST) break;
  }
  if (descriptor < 0) fail(path_, errno);
  struct stat existing {};
  const bool keeps_mode = ::stat(target_.c_str(), &existing) == 0;
  const bool mode_failed = keeps_mode && ::fchmod(descriptor, existing.st_mode & 07777) != 0;
  const int error = errno;
  try {
    stream_ = std::make_unique<Stream>(descriptor, path_);
  } catch (...) {
    ::unlink(temporary_.c_str());
    throw;
  }
  if (mode_failed) {
    ::unlink(temporary_.c_str());
    fail(path_, error);
  }
}

ReplacingFile::~ReplacingFile() {
  stream_.reset();
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

Imf::OStream& ReplacingFile::stream() noexcept { return *stream_; }

void ReplacingFile::commit() {
  stream_->finish();
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail(path_, errno);
  temporary_.clear();
  const fs::path folder = fs::path(target_).parent_path();
  sync_folder(folder.empty() ? fs::path(".") : folder);
}

}  // namespace stein::exr
