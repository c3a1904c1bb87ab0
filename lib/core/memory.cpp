// SPDX-License-Identifier: Apache-2.0
#include "stein/memory.hpp"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <system_error>

#include "core/aligned_zeros.hpp"
#include "core/memory_warnings.hpp"
#include "core/parameter_check.hpp"
#include "stein/error.hpp"

namespace stein {
namespace {

constexpr std::int64_t kLeast = std::int64_t{1} << 27;
constexpr std::int64_t kMost = std::int64_t{1} << 60;
constexpr double kWindowsToImages = 4;    // of what may lie on the heap
constexpr double kResidentShare = 0.875;  // from where on pages are given back: threads add some until the next look

std::string folder_of(const MemoryLimit& limit) {
  if (!limit.scratch_folder.empty()) return limit.scratch_folder;
  const char* folder = std::getenv("TMPDIR");
  return folder != nullptr && *folder != '\0' ? folder : "/var/tmp";
}

[[noreturn]] void fail(const std::string& folder, const std::string& what, int error) {
  throw Error(ErrorCode::kIo,
              "the scratch folder '" + folder + "' " + what + ": " + std::generic_category().message(error) +
                  "; name another one (--scratch, MemoryLimit::scratch_folder), or allow more memory",
              error);
}

class Descriptor {
 public:
  explicit Descriptor(int number) noexcept : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  [[nodiscard]] int number() const noexcept { return number_; }

 private:
  int number_;
};

/// A file without a name: nothing is left of it when the process is killed.
int open_unnamed(const std::string& folder) {
  constexpr mode_t kOwnerOnly = 0600;
  const int unnamed = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, kOwnerOnly);
  if (unnamed >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)) return unnamed;
  std::string name = folder + "/stein-scratch-XXXXXX";  // file systems without such files
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

/// Reserved on the disk: a full one is told now, and not by a signal when a page is used.
void reserve(int file, std::size_t bytes, const std::string& folder) {
  int error = EINTR;
  while (error == EINTR) error = ::posix_fallocate(file, 0, static_cast<off_t>(bytes));
  if (error != 0) fail(folder, "has no room for " + std::to_string(bytes) + " bytes", error);
}

}  // namespace

struct Memory::State : std::enable_shared_from_this<State> {
  explicit State(MemoryLimit from) : limit(std::move(from)), statm(::open("/proc/self/statm", O_RDONLY | O_CLOEXEC)) {}

  struct Bytes {
    std::int64_t image = 0;
    std::int64_t window = 0;
    [[nodiscard]] std::int64_t& of(Use use) noexcept { return use == Use::kImage ? image : window; }
  };

  [[nodiscard]] bool fits(std::size_t bytes, Use use) {
    if (limit.bytes == 0) return true;
    const double share = limit.image_share * (use == Use::kImage ? 1.0 : kWindowsToImages);
    const std::lock_guard lock(mutex);
    return static_cast<double>(heap.of(use)) + static_cast<double>(bytes) <= share * static_cast<double>(limit.bytes);
  }

  /// Counts bytes in `sums`, which give_back takes away again.
  void add(Bytes& sums, std::size_t bytes, Use use) {
    sums.of(use) += static_cast<std::int64_t>(bytes);
    most.scratch_bytes = std::max(most.scratch_bytes, scratch.image + scratch.window);
    most.scratch_window_bytes = std::max(most.scratch_window_bytes, scratch.window);
    most.window_bytes = std::max(most.window_bytes, heap.window + scratch.window);
  }

  [[nodiscard]] std::shared_ptr<void> on_heap(std::size_t bytes, Use use);
  [[nodiscard]] std::shared_ptr<void> in_file(std::size_t bytes, Use use);
  [[nodiscard]] std::int64_t resident_bytes() const noexcept;

  const MemoryLimit limit;
  const Descriptor statm;
  std::atomic<bool> has_files{false};
  std::mutex mutex;  // guards what follows
  Bytes heap;
  Bytes scratch;
  MemoryUsage most;
  std::map<void*, std::size_t> files;  // where they are mapped
};

std::shared_ptr<void> Memory::State::on_heap(std::size_t bytes, Use use) {
  const AlignedZeros zeros((bytes + sizeof(float) - 1) / sizeof(float));
  const auto give_back = [state = shared_from_this(), bytes, use](void* raw) {
    std::free(raw);
    const std::lock_guard lock(state->mutex);
    state->heap.of(use) -= static_cast<std::int64_t>(bytes);
  };
  {
    const std::lock_guard lock(mutex);
    add(heap, bytes, use);
  }
  return {std::shared_ptr<void>(zeros.raw, give_back), zeros.data};
}

std::shared_ptr<void> Memory::State::in_file(std::size_t bytes, Use use) {
  const std::string folder = folder_of(limit);
  const Descriptor file(open_unnamed(folder));
  if (file.number() < 0) fail(folder, "takes no file", errno);
  reserve(file.number(), bytes, folder);
  struct statfs system {};
  const bool is_memory = ::fstatfs(file.number(), &system) == 0 && system.f_type == TMPFS_MAGIC;
  void* address = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file.number(), 0);
  if (address == MAP_FAILED) fail(folder, "cannot be mapped", errno);
  const auto give_back = [state = shared_from_this(), bytes, use](void* mapped) {
    {
      const std::lock_guard lock(state->mutex);
      state->files.erase(mapped);
      state->scratch.of(use) -= static_cast<std::int64_t>(bytes);
    }
    ::munmap(mapped, bytes);
  };
  {
    const std::lock_guard lock(mutex);
    files.emplace(address, bytes);
    add(scratch, bytes, use);
    most.scratch_is_memory = most.scratch_is_memory || is_memory;
  }
  has_files = true;
  return {address, give_back};
}

std::int64_t Memory::State::resident_bytes() const noexcept {
  static const std::int64_t kPage = ::sysconf(_SC_PAGESIZE);
  std::array<char, 128> text{};  // pages in all, then resident ones
  const ssize_t length = ::pread(statm.number(), text.data(), text.size(), 0);
  const char* end = text.data() + std::max<ssize_t>(length, 0);
  const char* space = std::find(static_cast<const char*>(text.data()), end, ' ');
  std::int64_t pages = 0;
  if (space != end) std::from_chars(space + 1, end, pages);
  return pages * kPage;
}

Memory::Memory(MemoryLimit limit) : state_(std::make_shared<State>(std::move(limit))) {
  const MemoryLimit& own = state_->limit;
  if (own.bytes != 0 && (own.bytes < kLeast || own.bytes > kMost)) {
    throw Error(ErrorCode::kInvalidArgument, "the memory limit is " + std::to_string(own.bytes) +
                                                 " bytes; it must be 0 (none) or in [" + std::to_string(kLeast) + ", " +
                                                 std::to_string(kMost) + "]");
  }
  require_in_range("image_share", static_cast<float>(own.image_share), 0.0F, 0.15F);
  std::error_code error;
  if (!own.scratch_folder.empty() && !std::filesystem::is_directory(own.scratch_folder, error))
    throw Error(ErrorCode::kIo, "there is no folder '" + own.scratch_folder + "' for scratch files");
}

Memory::~Memory() = default;

const MemoryLimit& Memory::limit() const noexcept { return state_->limit; }

std::shared_ptr<void> Memory::allocate(std::size_t bytes, Use use) {
  return state_->fits(bytes, use) ? state_->on_heap(bytes, use) : state_->in_file(bytes, use);
}

void Memory::trim() const noexcept {
  if (!state_->has_files) return;
  const double most = kResidentShare * static_cast<double>(state_->limit.bytes);
  if (static_cast<double>(state_->resident_bytes()) < most) return;
  const std::unique_lock lock(state_->mutex, std::try_to_lock);  // where another thread trims, that is enough
  if (!lock) return;
  // Of a shared mapping nothing is lost: pages stay with the system until it has written them.
  for (const auto& [address, bytes] : state_->files) ::madvise(address, bytes, MADV_DONTNEED);
}

MemoryUsage Memory::usage() const {
  const std::lock_guard lock(state_->mutex);
  return state_->most;
}

void add_memory_warnings(const MemoryUsage& usage, std::vector<std::string>& warnings) {
  if (usage.scratch_window_bytes > 0) {
    warnings.push_back("of " + std::to_string(usage.window_bytes) + " bytes that windows of rows take, " +
                       std::to_string(usage.scratch_window_bytes) + " were in scratch files, which costs time; allow " +
                       std::to_string(2 * usage.window_bytes) + " bytes of memory or more, or fewer threads");
  }
  if (usage.scratch_is_memory) {
    warnings.emplace_back(
        "the scratch folder is memory itself (tmpfs): what lies there counts as well; name a folder on a disk");
  }
}

}  // namespace stein
