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

/// Every pixel of every plane is read once: the sanitizers see what was never written or lies outside.
float sum_of(const stein::ConstPlaneView& view) {
  float sum = 0;
  for (int y = 0; y < view.height(); ++y) {
    for (int x = 0; x < view.width(); ++x) sum += view.at(x, y);
  }
  return sum;
}

void look_at(const stein::Frame& frame) {
  volatile float sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum = sum_of(frame.colour[c]) + sum_of(frame.colour_variance[c]);
  for (const stein::Feature& feature : frame.features) {
    for (const auto& view : feature.mean) sum = sum_of(view);
    for (const auto& view : feature.variance) sum = sum_of(view);
    for (const auto& view : feature.colour_covariance) sum = sum_of(view);
  }
  static_cast<void>(sum);
}

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
    const stein::exr::LoadedFrame loaded =
        stein::exr::read_frame(path, {.samples_per_pixel = 4, .read_extra_layers = true});
    look_at(loaded.frame());
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

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static MemoryFile file;
  const std::string& path = file.fill(bytes, size);
  read_planes(path);
  read_samples(path);
  return 0;
}
