// SPDX-License-Identifier: Apache-2.0
//
// Images larger than memory: a limit for what a process holds at a time, and files for what goes beyond it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#pragma GCC visibility push(default)
namespace stein {

struct MemoryLimit {
  std::int64_t bytes = 0;  ///< resident memory of the whole process; 0: no limit, else [2^27..2^60]
  /// Where scratch files are made: a folder on a disk, not one that is memory itself (tmpfs). Empty: $TMPDIR, or
  /// /var/tmp where that is not set.
  std::string scratch_folder = {};
  /// Fraction of `bytes` that images may take before scratch files are made, [0..0.15]. The windows of rows that
  /// filters work in may take four times that; the rest is for threads and the pages of scratch files that are in use.
  double image_share = 0.125;
};

struct MemoryUsage {
  std::int64_t scratch_bytes = 0;         ///< of scratch files
  std::int64_t window_bytes = 0;          ///< of windows of rows, wherever they lay
  std::int64_t scratch_window_bytes = 0;  ///< of those that lay in scratch files
  bool scratch_is_memory = false;         ///< whether the scratch folder is memory itself, so that it counts
};

/// Memory for images under a limit. What does not fit lies in scratch files, which have no name and go with the
/// process, however it ends. They are mapped: pages that are in use are memory of the process, until trim() gives them
/// back to the system, which writes and reads them as it sees fit. One object serves for reading, filtering and
/// writing (ReadOptions::memory, Execution::memory), from any number of threads. Results do not depend on it.
class Memory {
 public:
  enum class Use : std::uint8_t {
    kImage,   ///< read and written in passes over the image
    kWindow,  ///< rows that are used over and over: last to go to files, as that costs time
  };

  /// @throws Error kInvalidArgument if the limit is out of range, kIo if a scratch folder that was named is none.
  explicit Memory(MemoryLimit limit);
  ~Memory();
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

  [[nodiscard]] const MemoryLimit& limit() const noexcept;

  /// `bytes` zeros at a multiple of 64; given back with the last copy of the pointer, which may outlive this object.
  /// @throws Error kIo naming the scratch folder where it has no room; std::bad_alloc.
  [[nodiscard]] std::shared_ptr<void> allocate(std::size_t bytes, Use use = Use::kImage);

  /// Where the process holds nearly as much as it may: gives back the pages of the scratch files. To be called every
  /// few rows of work; costs microseconds. Contents stay, and pages in use come back at once.
  void trim() const noexcept;

  /// The most that there was at a time.
  [[nodiscard]] MemoryUsage usage() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace stein
#pragma GCC visibility pop
