// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfIO.h>

#include <cstdint>
#include <fstream>
#include <limits>
#include <string>

namespace stein::exr {

/// What OpenEXR reads a file through. OpenEXR 3.1 copies tiles through a buffer of the size that a tile can have,
/// without looking whether the chunk claims to be larger: a limit on single reads stops that.
class GuardedStream : public Imf::IStream {
 public:
  static constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();

  /// @throws Error kIo if the file cannot be opened.
  explicit GuardedStream(const std::string& path);

  void set_limit(std::int64_t bytes) noexcept { limit_ = bytes; }

  bool read(char* to, int count) override;
  std::uint64_t tellg() override;
  void seekg(std::uint64_t position) override;
  void clear() override;

 private:
  std::string path_;
  std::ifstream file_;
  std::int64_t limit_ = kNoLimit;
};

}  // namespace stein::exr
