// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "exr/colour_space.hpp"
#include "exr/layout.hpp"
#include "exr/part_reader.hpp"
#include "stein/exr.hpp"

namespace stein::exr {
namespace {

/// As they are in the file, whatever their view.
std::vector<std::string> names_of(const SourceFile& file) {
  std::vector<std::string> names;
  for (const SourceChannel& channel : file.channels()) names.push_back(channel.name);
  return names;
}

class PlanesReader {
 public:
  explicit PlanesReader(const std::string& path)
      : file_(path), mapping_(find_mapping(path)), names_(name_channels(file_, *mapping_.schema, names_of(file_))) {}

  NamedPlanes read(std::vector<std::string> names, Memory* memory) {
    std::vector<int> found;
    for (const std::string& name : names) found.push_back(find(name));
    if (names.empty()) {
      found = find_colour();
      names = {"R", "G", "B"};
    }
    NamedPlanes result;
    const Imf::Header& first = file_.header(channel(found[0]).part);
    result.names = std::move(names);
    result.data_window = window_of(first);
    result.to_rec709 = colour_space(first, file_.path()).to_rec709;
    for (std::size_t i = 0; i < found.size(); ++i) check(found[i], result.names[i], result.data_window);
    for (std::size_t i = 0; i < found.size(); ++i)
      result.planes.emplace_back(width_of(first), height_of(first), memory);
    for (int part = 0; part < file_.parts(); ++part) read_part(part, found, memory, result.planes);
    return result;
  }

 private:
  [[nodiscard]] const SourceChannel& channel(int index) const {
    return file_.channels()[static_cast<std::size_t>(index)];
  }

  /// By the schema; by name where it knows none.
  [[nodiscard]] std::vector<int> find_colour() const {
    std::vector<int> found(3, -1);
    std::vector<const SchemaEntry*> by(3);
    for (std::size_t i = 0; i < names_.full.size(); ++i) {
      const SourceChannel& from = file_.channels()[i];
      const auto matched = match(*mapping_.schema, names_.full[i], mapping_.bindings);
      if (from.part != names_.main_part || !matched || matched->entry->role != Role::kColour) continue;
      const auto c = static_cast<std::size_t>(matched->colours[0]);
      if (by[c] != nullptr && by[c] <= matched->entry) continue;
      found[c] = static_cast<int>(i);
      by[c] = matched->entry;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      if (found[c] < 0) found[c] = find(std::string(1, "RGB"[c]));
    }
    return found;
  }

  /// By "part/channel", by full name, or by the name in the file where only one part has it.
  [[nodiscard]] int find(const std::string& name) const {
    const auto count = static_cast<int>(file_.channels().size());
    int by_name = -1;
    for (int i = 0; i < count; ++i) {
      if (names_.full[static_cast<std::size_t>(i)] == name ||
          file_.part_name(channel(i).part) + "/" + channel(i).name == name) {
        return i;
      }
      if (channel(i).name == name) by_name = by_name == -1 ? i : -2;
    }
    if (by_name >= 0) return by_name;
    std::string list;
    for (const std::string& known : names_.full) list += (list.empty() ? "" : ", ") + known;
    throw Error(ErrorCode::kInvalidFrame, "'" + file_.path() + "': it has no channel " + name + "; it has " + list);
  }

  void check(int index, const std::string& name, const std::array<int, 4>& window) const {
    const SourceChannel& from = channel(index);
    if (file_.is_deep(from.part) || from.subsampled) {
      throw Error(ErrorCode::kUnsupported, "'" + file_.path() + "': channel " + name + " is " +
                                               (from.subsampled ? "subsampled" : "deep") +
                                               "; stein reads flat channels of full resolution");
    }
    if (window_of(file_.header(from.part)) != window) {
      throw Error(ErrorCode::kInvalidFrame, "'" + file_.path() + "': the data window of channel " + name +
                                                " differs from that of the first channel; read them one by one");
    }
  }

  void read_part(int part, const std::vector<int>& found, const Memory* memory, std::vector<Plane>& planes) {
    const Imf::Header& header = file_.header(part);
    const Imath::V2i origin = header.dataWindow().min;
    Imf::FrameBuffer target;
    std::vector<std::pair<std::size_t, std::size_t>> copies;  // of channels that were asked for more than once
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (channel(found[i]).part != part) continue;
      const auto first = static_cast<std::size_t>(std::find(found.begin(), found.end(), found[i]) - found.begin());
      if (first != i) {
        copies.emplace_back(first, i);
        continue;
      }
      Plane& plane = planes[i];
      target.insert(channel(found[i]).name,
                    Imf::Slice::Make(Imf::FLOAT, plane.row(0), origin, plane.width(), plane.height(), sizeof(float),
                                     static_cast<std::size_t>(plane.row_stride())));
    }
    if (target.begin() == target.end()) return;
    const auto row_bytes = static_cast<std::int64_t>(found.size() * sizeof(float)) * width_of(header);
    PartReader(file_, part).read_all(target, row_bytes, memory);
    for (const auto& [from, to] : copies) {
      for (int y = 0; y < planes[to].height(); ++y) {
        std::copy_n(planes[from].row(y), planes[from].width(), planes[to].row(y));
        if (memory != nullptr) memory->trim();
      }
    }
  }

  SourceFile file_;
  Mapping mapping_;
  ChannelNames names_;
};

}  // namespace

NamedPlanes read_planes(const std::string& path, const std::vector<std::string>& names, Memory* memory) {
  return with_io_errors("read '" + path + "'", [&] { return PlanesReader(path).read(names, memory); });
}

}  // namespace stein::exr
