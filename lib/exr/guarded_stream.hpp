// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfIO.h>

#include <cstdint>
#include <fstream>
#include <string>

#include "exr/byte_progress.hpp"

namespace stein::exr {

/// What OpenEXR reads a file through. OpenEXR 3.1 copies a tile whose size in the file is negative: a read of a
/// negative count stops that here. Reports what it reads as progress, and so can be cancelled between any two chunks.
class GuardedStream : public Imf::IStream {
 public:
  /// @throws Error kIo if the file cannot be opened.
  GuardedStream(const std::string& path, ByteProgress& progress);

  bool read(char* to, int count) override;
  std::uint64_t tellg() override;
  void seekg(std::uint64_t position) override;
  void clear() override;

 private:
  std::string path_;
  std::ifstream file_;
  ByteProgress& progress_;
};

}  // namespace stein::exr
