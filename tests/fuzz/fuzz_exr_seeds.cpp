// SPDX-License-Identifier: Apache-2.0
//
// Writes small valid files of every storage and compression into a folder, for fuzz_exr to start from.
#include <cstdio>
#include <filesystem>
#include <string>

#include "exr/deep_fixture.hpp"
#include "exr/fixture.hpp"

using fixture::ChannelSpec;
using fixture::colour_channels;
using fixture::layer;
using fixture::native_channels;
using fixture::Storage;

namespace {

void write_seeds(const std::string& folder) {
  const std::array<int, 4> small = {-2, 1, 6, 9};
  int count = 0;
  const auto next = [&] { return folder + "/seed" + std::to_string(count++) + ".exr"; };
  for (int compression = Imf::NO_COMPRESSION; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    for (const Storage storage : {Storage::kScanlines, Storage::kTiles, Storage::kMipmap}) {
      const auto channels = colour_channels(Imf::HALF) + std::vector<ChannelSpec>{{"depth.Z", Imf::FLOAT}};
      fixture::write_file(next(), {{"", channels, small, storage, static_cast<Imf::Compression>(compression)}});
    }
  }
  fixture::write_file(next(), {{"",
                                native_channels() + layer("covariance.R", "GB", Imf::HALF) +
                                    layer("covariance.G", "B", Imf::HALF) + layer("light", "RGB", Imf::HALF),
                                small}});
  fixture::write_file(next(), {{"main", colour_channels(), small},
                               {"albedo", layer("", "RGB", Imf::HALF) + layer("variance", "RGB", Imf::HALF), small},
                               {"tiles", layer("", "XY", Imf::HALF), small, Storage::kMipmap, Imf::PIZ_COMPRESSION},
                               {"deep", layer("", "Z", Imf::FLOAT), small, Storage::kDeep, Imf::ZIPS_COMPRESSION}});
  for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION}) {
    fixture::write_deep_file(next(), {{{"R"}, {"G", Imf::HALF}, {"B", Imf::UINT}, {"depth.Z"}}, small, compression});
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: fuzz_exr_seeds FOLDER\n", stderr);
    return 2;
  }
  std::filesystem::create_directories(argv[1]);
  write_seeds(argv[1]);
  return 0;
}
