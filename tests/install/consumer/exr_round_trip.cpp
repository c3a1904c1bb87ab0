// SPDX-License-Identifier: Apache-2.0
//
// A project out of tree: writes a plane to an OpenEXR file and reads it back.
#include <cstdio>
#include <stein/exr.hpp>
#include <vector>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::vector<float> values = {1.0F, -2.5F, 1e20F, 0.0F, 5.0F, 6.0F};
  stein::exr::write_planes(argv[1], {{"depth.Z", stein::ConstPlaneView(values.data(), 3, 2)}});
  const stein::exr::NamedPlanes read = stein::exr::read_planes(argv[1], {"depth.Z"});
  bool same = read.planes.size() == 1 && read.planes[0].width() == 3 && read.planes[0].height() == 2;
  for (int i = 0; same && i < 6; ++i) same = read.planes[0].row(i / 3)[i % 3] == values[static_cast<std::size_t>(i)];
  same = std::remove(argv[1]) == 0 && same;
  std::printf("%s\n", same ? "read what was written" : "read something else");
  return same ? 0 : 1;
}
