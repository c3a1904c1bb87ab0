// SPDX-License-Identifier: Apache-2.0
#include "exr/views.hpp"

#include <ImfStandardAttributes.h>

#include <algorithm>

namespace stein::exr {
namespace {

bool has_several(const Imf::Header& header) { return Imf::hasMultiView(header) && Imf::multiView(header).size() > 1; }

bool contains(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

/// Where the view's name and the dot behind it begin and end; nothing where the channel says none.
struct ViewPart {
  std::size_t begin = 0;
  std::size_t end = 0;
};

ViewPart view_part(const std::string& channel, const std::vector<std::string>& views) {
  const std::size_t last = channel.rfind('.');
  if (last == std::string::npos) return {};
  const std::size_t before = last == 0 ? std::string::npos : channel.rfind('.', last - 1);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  if (!contains(views, channel.substr(begin, last - begin))) return {};
  return {begin, last + 1};
}

/// Empty: of another view.
std::string name_in_part(const std::string& channel, const std::vector<std::string>& views, const std::string& view) {
  const ViewPart part = view_part(channel, views);
  if (part.end == 0) return view == views.front() ? channel : "";
  if (channel.substr(part.begin, part.end - part.begin - 1) != view) return "";
  return channel.substr(0, part.begin) + channel.substr(part.end);
}

std::string joined(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

}  // namespace

std::vector<std::string> list_views(const SourceFile& file) {
  std::vector<std::string> views;
  for (int part = 0; part < file.parts() && file.is_own(part); ++part) {
    const Imf::Header& header = file.header(part);
    if (file.parts() == 1 && has_several(header)) return Imf::multiView(header);
    if (header.hasView() && !contains(views, header.view())) views.push_back(header.view());
  }
  return views.size() > 1 ? views : std::vector<std::string>();
}

std::vector<std::string> names_in_view(const SourceFile& file, const std::string& view) {
  const std::vector<std::string> views = list_views(file);
  if (!view.empty() && !contains(views, view)) {
    throw Error(ErrorCode::kInvalidArgument, "'" + file.path() + "': it has no view " + view + "; it has " +
                                                 (views.empty() ? "one view without a name" : joined(views)));
  }
  const std::string wanted = view.empty() && !views.empty() ? views.front() : view;
  std::vector<std::string> names;
  names.reserve(file.channels().size());
  for (const SourceChannel& channel : file.channels()) {
    const Imf::Header& header = file.header(channel.part);
    if (views.empty()) {
      names.push_back(channel.name);
    } else if (has_several(header)) {
      names.push_back(name_in_part(channel.name, views, wanted));
    } else {
      names.push_back(!header.hasView() || header.view() == wanted ? channel.name : "");
    }
  }
  return names;
}

std::string name_for_view(const SourceFile& file, int part, const std::string& view, const std::string& name) {
  const Imf::Header& header = file.header(part);
  if (view.empty() || !has_several(header) || view == Imf::multiView(header).front()) return name;
  const std::size_t dot = name.rfind('.');
  return dot == std::string::npos ? view + "." + name : name.substr(0, dot + 1) + view + "." + name.substr(dot + 1);
}

}  // namespace stein::exr
