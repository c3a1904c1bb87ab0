// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "exr/colour_space.hpp"
#include "exr/mapping.hpp"
#include "stein/exr.hpp"

namespace stein::exr {

/// Memory for planes, aligned to cache lines: pages that are never read into cost nothing.
class PlaneMemory {
 public:
  static constexpr std::size_t kAlignment = 64;

  PlaneMemory() = default;
  explicit PlaneMemory(std::size_t bytes) : block_(::operator new (bytes, std::align_val_t{kAlignment}), Free{}) {}
  PlaneMemory(std::size_t bytes, Memory& memory) : block_(memory.allocate(bytes)) {}

  [[nodiscard]] std::byte* data() const noexcept { return static_cast<std::byte*>(block_.get()); }

 private:
  struct Free {
    void operator()(void* data) const noexcept { ::operator delete (data, std::align_val_t{kAlignment}); }
  };
  std::shared_ptr<void> block_;
};

struct LoadedFrame::Data {
  std::string path;
  Mapping mapping;
  std::shared_ptr<Memory> memory;  // what ReadOptions had
  PlaneMemory planes;
  std::vector<Plane> converted;  // planes that the file holds in another form
  Frame frame;
  std::vector<ChannelInfo> channels;
  std::array<int, 4> data_window{};
  ColourSpace colour_space;
  std::vector<std::string> missing;
  std::string schema;
  std::vector<std::string> assumptions;
  std::vector<std::string> views;
  std::string view;
  std::string straight_alpha;                 // layer with the alpha that the file's colour is divided by; empty: none
  std::array<ConstPlaneView, 3> file_colour;  // as it is in the file
};

}  // namespace stein::exr
