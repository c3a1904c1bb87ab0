// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfIO.h>

#include <cstdint>
#include <fstream>
#include <string>

namespace stein::exr {

/// What OpenEXR reads a file through. OpenEXR 3.1 copies a tile whose size in the file is negative: a read of a
/// negative count stops that here.
class GuardedStream : public Imf::IStream {
 public:
  /// @throws Error kIo if the file cannot be opened.
  explicit GuardedStream(const std::string& path);

  bool read(char* to, int count) override;
  std::uint64_t tellg() override;
  void seekg(std::uint64_t position) override;
  void clear() override;

 private:
  std::string path_;
  std::ifstream file_;
};

}  // namespace stein::exr
