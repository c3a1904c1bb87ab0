// SPDX-License-Identifier: Apache-2.0
//
// A file that appears under its name whole or not at all.
#pragma once

#include <ImfIO.h>

#include <cstdio>
#include <functional>
#include <memory>
#include <string>

namespace stein::exr {

/// Bytes go to a temporary file in the folder of the target; `commit` brings it to the disk and renames it. Without a
/// commit it is removed. A symbolic link is followed; an existing file keeps its permissions. Any number of processes
/// may write the same target: each has a temporary file of its own, and the last commit stays. What a killed process
/// leaves is removed when the target is next written: the writer of a temporary file holds a lock on it (flock), which
/// ends with the process.
class ReplacingFile {
 public:
  /// @throws Error kIo naming the target.
  explicit ReplacingFile(const std::string& path);
  ReplacingFile(const ReplacingFile&) = delete;
  ReplacingFile& operator=(const ReplacingFile&) = delete;
  ~ReplacingFile();

  [[nodiscard]] Imf::OStream& stream() noexcept;

  /// Called before any bytes go to the stream; what it throws fails the write, and `commit` as well.
  void before_each_write(std::function<void()> action);

  /// Only after everything that writes to the stream is gone.
  /// @throws Error kIo, also for a write that failed earlier in a destructor, which cannot throw.
  void commit();

 private:
  class Stream;

  /// Lasts until the file has its name, longer than the stream.
  struct Lock {
    Lock() = default;
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;
    ~Lock();
    int descriptor = -1;
  };

  void open_temporary();
  [[nodiscard]] int create_temporary();

  std::string path_;
  std::string target_;  // `path_` with links resolved
  std::string temporary_;
  Lock lock_;
  std::unique_ptr<Stream> stream_;
};

}  // namespace stein::exr
