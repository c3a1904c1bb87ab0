// SPDX-License-Identifier: Apache-2.0
//
// A file that appears under its name whole or not at all.
#pragma once

#include <ImfIO.h>

#include <cstdio>
#include <memory>
#include <string>

namespace stein::exr {

/// Bytes go to a temporary file in the folder of the target; `commit` brings it to the disk and renames it. Without a
/// commit it is removed. A symbolic link is followed; an existing file keeps its permissions.
class ReplacingFile {
 public:
  /// @throws Error kIo naming the target.
  explicit ReplacingFile(const std::string& path);
  ReplacingFile(const ReplacingFile&) = delete;
  ReplacingFile& operator=(const ReplacingFile&) = delete;
  ~ReplacingFile();

  [[nodiscard]] Imf::OStream& stream() noexcept;

  /// Only after everything that writes to the stream is gone.
  /// @throws Error kIo, also for a write that failed earlier in a destructor, which cannot throw.
  void commit();

 private:
  class Stream;

  void open_temporary();

  std::string path_;
  std::string target_;  // `path_` with links resolved
  std::string temporary_;
  std::unique_ptr<Stream> stream_;
};

}  // namespace stein::exr
