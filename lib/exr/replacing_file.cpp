// SPDX-License-Identifier: Apache-2.0
#include "exr/replacing_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <filesystem>
#include <random>
#include <string_view>
#include <system_error>
#include <utility>

#include "stein/error.hpp"
#include "stein/exr.hpp"

namespace stein::exr {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, int error) {
  throw Error(ErrorCode::kIo, "cannot write '" + path + "': " + std::generic_category().message(error), error);
}

// Temporary files of out.exr are .out.exr.*.stein-tmp.
constexpr std::string_view kSuffix = ".stein-tmp";

std::string temporary_prefix(const fs::path& target) {
  constexpr std::size_t kLongestPart = 200;  // file systems allow 255 in all
  return "." + target.filename().string().substr(0, kLongestPart) + ".";
}

std::string random_digits() {
  std::random_device entropy;
  constexpr std::string_view kDigits = "0123456789abcdefghijklmnopqrstuv";
  std::string digits;
  for (int i = 0; i < 12; ++i) digits += kDigits[entropy() % kDigits.size()];
  return digits;
}

bool is_temporary(const std::string& name, const std::string& prefix) {
  return name.size() > prefix.size() + kSuffix.size() && name.compare(0, prefix.size(), prefix) == 0 &&
         name.compare(name.size() - kSuffix.size(), kSuffix.size(), kSuffix) == 0;
}

/// Whose writer lives is locked. Where locks are not to be had, nothing is removed.
void remove_if_orphaned(const fs::path& temporary) {
  const int descriptor = ::open(temporary.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return;
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) ::unlink(temporary.c_str());
  ::close(descriptor);
}

void remove_orphans(const fs::path& target) {
  const std::string prefix = temporary_prefix(target);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  std::error_code error;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    if (is_temporary(entry->path().filename().string(), prefix)) remove_if_orphaned(entry->path());
  }
}

/// Another process may take a file that is not locked yet for an orphan, and remove it.
bool lock_and_keep(int descriptor, const std::string& path) {
  while (::flock(descriptor, LOCK_EX) != 0 && errno == EINTR) {
  }
  struct stat opened {};
  struct stat named {};
  return ::fstat(descriptor, &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino;
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
    ask_before_write();
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

  void before_each_write(std::function<void()> action) { before_ = std::move(action); }

  /// To the disk, then closed.
  void finish() {
    if (refusal_) std::rethrow_exception(refusal_);
    if (error_ != 0) fail(path_, error_);
    if (std::fflush(file_) != 0 || ::fsync(::fileno(file_)) != 0) remember_and_fail();
    std::FILE* file = std::exchange(file_, nullptr);
    if (std::fclose(file) != 0) fail(path_, errno);
  }

 private:
  /// Remembered: OpenEXR writes its last bytes in a destructor, which swallows what is thrown.
  void ask_before_write() {
    if (!before_) return;
    try {
      before_();
    } catch (...) {
      refusal_ = std::current_exception();
      throw;
    }
  }

  [[noreturn]] void remember_and_fail() {
    error_ = errno != 0 ? errno : EIO;
    fail(path_, error_);
  }

  std::string path_;
  std::FILE* file_;
  int error_ = 0;
  std::function<void()> before_;
  std::exception_ptr refusal_;
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
  const int descriptor = create_temporary();
  lock_.descriptor = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
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

int ReplacingFile::create_temporary() {
  const fs::path target(target_);
  remove_orphans(target);
  constexpr mode_t kReadWriteAll = 0666;  // the caller's umask takes away from it
  for (int attempt = 0; attempt < 100; ++attempt) {
    const std::string name = temporary_prefix(target) + random_digits() + std::string(kSuffix);
    const std::string path = (target.parent_path() / name).string();
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, kReadWriteAll);
    if (descriptor < 0 && errno != EEXIST) break;
    if (descriptor >= 0 && lock_and_keep(descriptor, path)) {
      temporary_ = path;
      return descriptor;
    }
    if (descriptor >= 0) ::close(descriptor);
  }
  fail(path_, errno);
}

ReplacingFile::~ReplacingFile() {
  stream_.reset();
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

ReplacingFile::Lock::~Lock() {
  if (descriptor >= 0) ::close(descriptor);
}

Imf::OStream& ReplacingFile::stream() noexcept { return *stream_; }

void ReplacingFile::before_each_write(std::function<void()> action) { stream_->before_each_write(std::move(action)); }

void ReplacingFile::commit() {
  stream_->finish();
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail(path_, errno);
  temporary_.clear();
  const fs::path folder = fs::path(target_).parent_path();
  sync_folder(folder.empty() ? fs::path(".") : folder);
}

void write_bytes(const std::string& path, std::string_view bytes) {
  constexpr std::size_t kMost = std::size_t{1} << 30;  // a stream counts in int
  ReplacingFile target(path);
  for (; !bytes.empty(); bytes.remove_prefix(std::min(kMost, bytes.size()))) {
    target.stream().write(bytes.data(), static_cast<int>(std::min(kMost, bytes.size())));
  }
  target.commit();
}

}  // namespace stein::exr
