// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as an OpenEXR file: reading it, as planes or as raw samples, and writing a result next to what the file
// holds, may only end in an Error.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "input.hpp"
#include "look_at.hpp"
#include "stein/error.hpp"
#include "stein/exr.hpp"
#include "stein/exr_samples.hpp"

namespace {

using stein::Plane;

/// A file in memory that has a path.
class MemoryFile {
 public:
  MemoryFile()
      : descriptor_(::memfd_create("fuzz", MFD_CLOEXEC)), path_("/proc/self/fd/" + std::to_string(descriptor_)) {
    if (descriptor_ < 0) std::abort();
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { ::close(descriptor_); }

  const std::string& fill(const std::uint8_t* bytes, std::size_t size) {
    if (::ftruncate(descriptor_, 0) != 0 || ::pwrite(descriptor_, bytes, size, 0) != static_cast<ssize_t>(size)) {
      std::abort();
    }
    return path_;
  }

 private:
  int descriptor_;
  std::string path_;
};

void rewrite(const stein::exr::LoadedFrame& loaded) {
  static const std::string target =
      (std::filesystem::temp_directory_path() / ("stein-fuzz-" + std::to_string(::getpid()) + ".exr")).string();
  const stein::Frame& frame = loaded.frame();
  stein::DenoiseResult result;
  for (std::size_t c = 0; c < 3; ++c) {
    result.colour[c] = Plane(frame.width, frame.height);
    result.error[c] = Plane(frame.width, frame.height);
  }
  result.choice = Plane(frame.width, frame.height);
  result.density = Plane(frame.width, frame.height);
  stein::exr::write_result(target, loaded, result, {.noisy = true, .half_colour = true});
  std::filesystem::remove(target);
}

void read_planes(const std::string& path) {
  try {
    const stein::exr::LoadedFrame loaded = stein::exr::read_frame(path, {.samples_per_pixel = 4, .layers = {"all"}});
    stein::fuzz::look_at(loaded.frame());
    // Small images are enough to reach all of the writer.
    if (loaded.frame().width * static_cast<std::int64_t>(loaded.frame().height) < 100'000) rewrite(loaded);
  } catch (const stein::Error&) {
    // The promised end of a damaged file.
  }
}

void read_samples(const std::string& path) {
  try {
    stein::exr::SampleReader reader(path);
    std::vector<std::uint32_t> counts;
    std::vector<float> samples;
    volatile float sum = 0;
    while (reader.read_row(counts, samples)) {
      for (const float value : samples) sum = sum + value;
    }
  } catch (const stein::Error&) {
    // As above.
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static MemoryFile file;
  const std::string& path = file.fill(bytes, size);
  read_planes(path);
  read_samples(path);
  return 0;
}
