// SPDX-License-Identifier: Apache-2.0
//
// Frames of any size for measurements of time and memory, made and compared a few rows at a time:
//   stein_large_frame make OUT.exr WIDTH HEIGHT [X Y]       the pixels from (X, Y) on of an endless noisy picture
//   stein_large_frame compare A.exr B.exr X Y MARGIN        whether the colour of A, from its pixel (X, Y) on, has the
//                                                           bits of B's, but for B's outermost pixels; estimated
//                                                           errors may not: perturbations differ from place to place
#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfThreading.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

constexpr int kRows = 64;  // at a time

// All of them are bounded by nature, so that no range is taken from the image as a whole.
const std::vector<std::string> kMeans = {"R",        "G",        "B",        "albedo.R", "albedo.G",
                                         "albedo.B", "normal.X", "normal.Y", "normal.Z", "visibility.V"};

std::string variance_name(const std::string& mean) {
  const std::size_t dot = mean.find('.');
  return dot == std::string::npos ? "variance." + mean : mean.substr(0, dot) + ".variance." + mean.substr(dot + 1);
}

std::uint32_t hash(std::uint32_t x, std::uint32_t y, std::uint32_t channel) {
  std::uint32_t h = x * 0x9E3779B1U ^ y * 0x85EBCA77U ^ (channel + 1) * 0xC2B2AE3DU;
  h = (h ^ (h >> 16)) * 0x7FEB352DU;
  h = (h ^ (h >> 15)) * 0x846CA68BU;
  return h ^ (h >> 16);
}

// In steps of 1/256, so that files compress about as well as renders do.
float noise(int x, int y, std::size_t channel) {
  const std::uint32_t h =
      hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(channel));
  return (static_cast<float>(h >> 24) + 0.5F) / 128.0F - 1.0F;
}

float scene(int x, int y, std::size_t channel) {
  const bool is_square = ((x / 48 + y / 48) & 1) != 0;
  const auto tint = static_cast<float>(channel % 3) * 0.125F;
  return (is_square ? 0.75F : 0.25F) + tint;
}

struct Pixel {
  float mean;
  float variance;  // of the mean
};

Pixel pixel(int x, int y, std::size_t channel) {
  const bool is_colour = channel < 3;
  const float value = scene(x, y, channel);
  const float deviation = is_colour ? value * 0.5F : 0.03125F;
  const float estimate = 1.0F + 0.25F * noise(x, y, channel + kMeans.size());
  return {value + 1.7F * deviation * noise(x, y, channel), deviation * deviation * estimate};
}

void make(const std::string& path, int width, int height, int x0, int y0) {
  Imf::Header header(width, height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer buffer;
  std::vector<std::vector<float>> rows(2 * kMeans.size(), std::vector<float>(static_cast<std::size_t>(width) * kRows));
  const auto add = [&](const std::string& name, std::vector<float>& memory) {
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    const auto stride = static_cast<std::size_t>(width) * sizeof(float);
    // The same rows of memory for each block of the file.
    buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(memory.data()), sizeof(float), stride));
  };
  for (std::size_t k = 0; k < kMeans.size(); ++k) {
    add(kMeans[k], rows[2 * k]);
    add(variance_name(kMeans[k]), rows[2 * k + 1]);
  }
  header.insert("samplesPerPixel", Imf::IntAttribute(8));
  Imf::OutputFile file(path.c_str(), header);
  for (int row = 0; row < height; row += kRows) {
    const int count = std::min(kRows, height - row);
    for (std::size_t k = 0; k < kMeans.size(); ++k) {
      for (int y = 0; y < count; ++y) {
        for (int x = 0; x < width; ++x) {
          const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
          const Pixel value = pixel(x0 + x, y0 + row + y, k);
          rows[2 * k][at] = value.mean;
          rows[2 * k + 1][at] = value.variance;
        }
      }
    }
    Imf::FrameBuffer block;
    for (auto it = buffer.begin(); it != buffer.end(); ++it) {
      Imf::Slice slice = it.slice();
      slice.base -= static_cast<std::ptrdiff_t>(row) * static_cast<std::ptrdiff_t>(slice.yStride);
      block.insert(it.name(), slice);
    }
    file.setFrameBuffer(block);
    file.writePixels(count);
  }
}

class RowReader {
 public:
  explicit RowReader(const std::string& path) : file_(path.c_str()) {}
  [[nodiscard]] int width() const { return file_.header().dataWindow().max.x + 1; }
  [[nodiscard]] int height() const { return file_.header().dataWindow().max.y + 1; }
  const std::vector<float>& row(const char* channel, int y) {
    row_.resize(static_cast<std::size_t>(width()));
    Imf::FrameBuffer buffer;
    buffer.insert(channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(row_.data()), sizeof(float), 0));
    file_.setFrameBuffer(buffer);
    file_.readPixels(y);
    return row_;
  }

 private:
  Imf::InputFile file_;
  std::vector<float> row_;
};

void compare(const std::string& path, const std::string& part_path, int x0, int y0, int margin) {
  RowReader whole(path);
  RowReader part(part_path);
  const int width = part.width() - 2 * margin;
  if (width < 1 || part.height() <= 2 * margin) throw std::runtime_error("nothing is left within the margin");
  for (const char* channel : {"R", "G", "B"}) {
    for (int y = margin; y < part.height() - margin; ++y) {
      const float* a = whole.row(channel, y0 + y).data() + x0 + margin;
      const float* b = part.row(channel, y).data() + margin;
      if (std::memcmp(a, b, static_cast<std::size_t>(width) * sizeof(float)) == 0) continue;
      throw std::runtime_error(std::string(channel) + " differs in row " + std::to_string(y) + " of " + part_path);
    }
  }
  std::printf("identical: %d x %d pixels\n", width, part.height() - 2 * margin);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const auto number = [&](std::size_t i) { return i < words.size() ? std::stoi(words[i]) : 0; };
  try {
    Imf::setGlobalThreadCount(static_cast<int>(std::thread::hardware_concurrency()));
    if (words.size() >= 4 && words[0] == "make") {
      make(words[1], number(2), number(3), number(4), number(5));
    } else if (words.size() == 6 && words[0] == "compare") {
      compare(words[1], words[2], number(3), number(4), number(5));
    } else {
      throw std::runtime_error("make OUT.exr WIDTH HEIGHT [X Y], or compare A.exr B.exr X Y MARGIN");
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stein_large_frame: %s\n", error.what());
    return 1;
  }
  return 0;
}
