// SPDX-License-Identifier: Apache-2.0
//
// Output files appear whole or not at all.
#include <sys/stat.h>

#include "catch.hpp"
#include "expect_error.hpp"
#include "file_size_limit.hpp"
#include "fixture.hpp"

namespace fixture {

using stein::DenoiseResult;
using stein::ErrorCode;
using stein::exr::LoadedFrame;
using stein::exr::read_frame;
using stein::exr::read_planes;
using stein::exr::write_planes;
using stein::exr::write_result;

TEST_CASE("a file can be its own target") {
  const TemporaryFolder folder;
  const std::string path = folder / "frame.exr";
  auto channels = native_channels();
  channels.push_back({"id", Imf::UINT, true});
  write_file(path, {{"", channels, {0, 0, 99, 199}}});
  ::chmod(path.c_str(), 0640);
  const auto id = read_raw(path, 0, "id");
  const auto noisy = read_raw(path, 0, "R");
  const LoadedFrame source = read_frame(path);
  const DenoiseResult result = result_for(source.frame());
  SECTION("directly") { write_result(path, source, result, {.noisy = true}); }
  SECTION("through a link, which stays one") {
    std::filesystem::create_symlink("frame.exr", folder / "link.exr");
    write_result(folder / "link.exr", source, result, {.noisy = true});
    CHECK(std::filesystem::is_symlink(folder / "link.exr"));
    std::filesystem::remove(folder / "link.exr");
  }
  CHECK(read_raw(path, 0, "id") == id);
  CHECK(read_raw(path, 0, "noisy.R") == noisy);
  CHECK(read_planes(path).planes[0].row(5)[7] == result.colour[0].row(5)[7]);
  struct stat status {};
  ::stat(path.c_str(), &status);
  CHECK((status.st_mode & 0777U) == 0640U);
  CHECK(folder.entries() == 1);
}

TEST_CASE("places that cannot be written to are named") {
  const TemporaryFolder folder;
  write_file(folder / "in.exr", {{"", native_channels()}});
  const LoadedFrame source = read_frame(folder / "in.exr");
  const DenoiseResult result = result_for(source.frame());
  const std::string nowhere = folder / "no/such/folder/out.exr";
  expect_error(ErrorCode::kIo, {nowhere, "No such file"}, [&] { write_result(nowhere, source, result); });
  const std::string below_file = folder / "in.exr/out.exr";
  expect_error(ErrorCode::kIo, {below_file}, [&] { write_result(below_file, source, result); });
  const std::string itself = folder.path().string();
  expect_error(ErrorCode::kIo, {itself, "not a regular file"}, [&] { write_result(itself, source, result); });
  CHECK(folder.entries() == 1);
}

TEST_CASE("a full disk leaves the old file and nothing else") {
  const TemporaryFolder folder;
  const std::string path = folder / "out.exr";
  auto channels = native_channels();
  channels.push_back({"id", Imf::UINT, true});
  write_file(folder / "in.exr", {{"", channels, {0, 0, 99, 199}}});
  const LoadedFrame source = read_frame(folder / "in.exr");
  const DenoiseResult result = result_for(source.frame());
  write_result(path, source, result);
  const auto size = static_cast<rlim_t>(std::filesystem::file_size(path));
  write_bytes(path, {'o', 'l', 'd'});
  // Also where only the very last bytes do not fit, which OpenEXR writes in a destructor.
  for (const rlim_t limit : {rlim_t{0}, rlim_t{100}, size / 4, size / 2, size - 1}) {
    const FileSizeLimit full_disk(limit);
    expect_error(ErrorCode::kIo, {path}, [&] { write_result(path, source, result); });
  }
  CHECK(bytes_of(path) == std::vector<unsigned char>{'o', 'l', 'd'});
  {
    const FileSizeLimit full_disk(100);
    expect_error(ErrorCode::kIo, {path}, [&] { write_planes(path, {{"x", result.colour[0].view()}}); });
  }
  CHECK(bytes_of(path) == std::vector<unsigned char>{'o', 'l', 'd'});
  CHECK(folder.entries() == 2);
}

TEST_CASE("a source that breaks off after it was read fails the result") {
  const TemporaryFolder folder;
  write_file(folder / "in.exr", {{"", native_channels(), {0, 0, 99, 199}}});
  const LoadedFrame source = read_frame(folder / "in.exr");
  const DenoiseResult result = result_for(source.frame());
  auto bytes = bytes_of(folder / "in.exr");
  SECTION("truncated") {
    bytes.resize(bytes.size() * 3 / 4);
    write_bytes(folder / "in.exr", bytes);
    expect_error(ErrorCode::kIo, {folder / "in.exr", "truncated"},
                 [&] { write_result(folder / "out.exr", source, result); });
    CHECK(folder.entries() == 1);
  }
  SECTION("another image") {
    write_file(folder / "in.exr", {{"", native_channels(), {0, 0, 9, 19}}});
    expect_error(ErrorCode::kIo, {folder / "in.exr", "changed"},
                 [&] { write_result(folder / "out.exr", source, result); });
    CHECK(folder.entries() == 1);
  }
  SECTION("gone") {
    std::filesystem::remove(folder / "in.exr");
    expect_error(ErrorCode::kIo, {folder / "in.exr", "no such file"},
                 [&] { write_result(folder / "out.exr", source, result); });
    CHECK(folder.entries() == 0);
  }
}

TEST_CASE("a result of another size is refused") {
  const TemporaryFolder folder;
  write_file(folder / "in.exr", {{"", native_channels()}});
  const LoadedFrame source = read_frame(folder / "in.exr");
  DenoiseResult result = result_for(source.frame());
  result.density = stein::Plane(4, 5);
  expect_error(ErrorCode::kInvalidArgument, {"density.V", "4 x 5", "23 x 13"},
               [&] { write_result(folder / "out.exr", source, result); });
  CHECK(folder.entries() == 1);
}

}  // namespace fixture
