// SPDX-License-Identifier: Apache-2.0
#include <ImfChannelList.h>
#include <ImfPartType.h>

#include <set>

#include "exr/part_writer.hpp"
#include "exr/replacing_file.hpp"
#include "stein/exr.hpp"

namespace stein::exr {
namespace {

constexpr std::size_t kLongestName = 255;  // of OpenEXR

[[noreturn]] void fail(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::kInvalidArgument, "cannot write '" + path + "': " + why);
}

void check_planes(const std::string& path, const std::vector<std::pair<std::string, ConstPlaneView>>& planes) {
  if (planes.empty()) fail(path, "no planes are given");
  const ConstPlaneView& first = planes.front().second;
  std::set<std::string> seen;
  for (const auto& [name, view] : planes) {
    if (name.empty() || name.size() > kLongestName) fail(path, "a plane's name must have 1 to 255 characters");
    if (!seen.insert(name).second) fail(path, "plane " + name + " is given twice");
    if (!view || view.width() < 1 || view.height() < 1) fail(path, "plane " + name + " is empty");
    if (view.width() != first.width() || view.height() != first.height()) {
      fail(path, "plane " + name + " has " + std::to_string(view.width()) + " x " + std::to_string(view.height()) +
                     " pixels, but " + planes.front().first + " has " + std::to_string(first.width()) + " x " +
                     std::to_string(first.height()));
    }
  }
}

/// The views themselves; `copies` holds those of half values as floats.
std::vector<MemoryChannel> channels_of(const std::vector<std::pair<std::string, ConstPlaneView>>& planes,
                                       std::vector<Plane>& copies) {
  std::vector<MemoryChannel> channels;
  for (const auto& [name, view] : planes) {
    channels.push_back({name, view.type() == ScalarType::kUint32 ? Imf::UINT : Imf::FLOAT, view});
    if (view.type() != ScalarType::kFloat16) continue;
    Plane copy(view.width(), view.height());
    for (int y = 0; y < view.height(); ++y) view.read_row(y, 0, view.width(), copy.row(y));
    channels.back().view = copy.view();
    copies.push_back(std::move(copy));
  }
  return channels;
}

}  // namespace

void write_planes(const std::string& path, const std::vector<std::pair<std::string, ConstPlaneView>>& planes,
                  const std::array<int, 2>& origin) {
  check_planes(path, planes);
  with_io_errors("write '" + path + "'", [&] {
    std::vector<Plane> copies;
    const std::vector<MemoryChannel> channels = channels_of(planes, copies);
    PartPlan plan;
    const ConstPlaneView& first = planes.front().second;
    const Imath::V2i corner(origin[0], origin[1]);
    const Imath::Box2i window(corner, corner + Imath::V2i(first.width() - 1, first.height() - 1));
    plan.header = Imf::Header(window, window);
    plan.header.compression() = Imf::ZIP_COMPRESSION;
    plan.header.setType(Imf::SCANLINEIMAGE);
    for (const MemoryChannel& channel : channels) {
      plan.header.channels().insert(channel.name, Imf::Channel(channel.type));
    }
    ReplacingFile target(path);
    {
      Imf::MultiPartOutputFile output(target.stream(), &plan.header, 1);
      write_part(nullptr, plan, channels, output, 0);
    }
    target.commit();
  });
}

}  // namespace stein::exr
