// SPDX-License-Identifier: Apache-2.0
#include "stein/memory.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <vector>

#include "catch.hpp"
#include "exr/expect_error.hpp"
#include "exr/file_size_limit.hpp"
#include "stein/plane.hpp"
#include "support/sanitizers.hpp"
#include "support/temporary_folder.hpp"

namespace stein {
namespace {

constexpr std::int64_t kLeast = std::int64_t{1} << 27;
constexpr std::size_t kMiB = std::size_t{1} << 20;

std::size_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t pages = 0;
  statm >> pages >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

bool is_zero(const void* data, std::size_t bytes) {
  const auto* values = static_cast<const char*>(data);
  return values[0] == 0 && std::memcmp(values, values + 1, bytes - 1) == 0;
}

}  // namespace

TEST_CASE("memory: aligned zeros, on the heap up to the share and in a file without a name beyond it") {
  const TemporaryFolder folder;
  Memory memory({kLeast, folder.path().string()});
  const auto small = memory.allocate(kMiB + 3);
  CHECK(memory.usage().scratch_bytes == 0);
  const auto large = memory.allocate(16 * kMiB);
  const auto window = memory.allocate(60 * kMiB, Memory::Use::kWindow);
  CHECK(memory.usage().scratch_bytes == 16 * kMiB);
  CHECK(memory.usage().window_bytes == 60 * kMiB);
  CHECK(memory.usage().scratch_window_bytes == 0);
  const auto second_window = memory.allocate(5 * kMiB, Memory::Use::kWindow);
  CHECK(memory.usage().scratch_bytes == 21 * kMiB);
  CHECK(memory.usage().scratch_window_bytes == 5 * kMiB);
  for (const void* block : {small.get(), large.get(), second_window.get()}) {
    CHECK(reinterpret_cast<std::uintptr_t>(block) % 64 == 0);
    CHECK(is_zero(block, kMiB));
  }
  CHECK(folder.entries() == 0);
}

TEST_CASE("memory: what is given back may be used again") {
  const TemporaryFolder folder;
  Memory memory({kLeast, folder.path().string()});
  for (int i = 0; i < 20; ++i) {
    (void)memory.allocate(15 * kMiB);
    (void)memory.allocate(60 * kMiB, Memory::Use::kWindow);
  }
  CHECK(memory.usage().scratch_bytes == 0);
  for (int i = 0; i < 3; ++i) (void)memory.allocate(20 * kMiB);
  CHECK(memory.usage().scratch_bytes == 20 * kMiB);  // at a time
}

TEST_CASE("memory: without a limit nothing goes to files") {
  Memory memory({});
  const auto block = memory.allocate(300 * kMiB);
  CHECK(memory.usage().scratch_bytes == 0);
}

TEST_CASE("memory: blocks outlive it") {
  const TemporaryFolder folder;
  Plane in_file;
  Plane on_heap;
  {
    Memory none_on_heap({kLeast, folder.path().string(), 0.0});
    in_file = Plane(100, 100, &none_on_heap);
    CHECK(none_on_heap.usage().scratch_bytes > 0);
    Memory memory({kLeast, folder.path().string()});
    on_heap = Plane(100, 100, &memory);
  }
  in_file.row(99)[99] = 3.0F;
  on_heap.row(99)[99] = 3.0F;
  CHECK(in_file.row(99)[99] == on_heap.row(99)[99]);
}

#if !STEIN_HAS_TSAN && !STEIN_HAS_ASAN  // they take memory of their own
TEST_CASE("memory: trimmed, the process holds less than the limit and loses nothing") {
  const TemporaryFolder folder;
  Memory memory({kLeast, folder.path().string()});
  constexpr std::size_t kBlocks = 8;
  std::vector<std::shared_ptr<void>> blocks;
  for (std::size_t b = 0; b < kBlocks; ++b) blocks.push_back(memory.allocate(40 * kMiB));
  std::size_t most = 0;
  const auto for_each_mib = [&](const auto& visit) {
    for (std::size_t i = 0; i < 40 * kBlocks; ++i) {
      visit(static_cast<unsigned char*>(blocks[i % kBlocks].get()) + i / kBlocks * kMiB, static_cast<int>(i % 251 + 1));
      most = std::max(most, resident_bytes());
      memory.trim();
    }
  };
  for_each_mib([](unsigned char* block, int value) { std::memset(block, value, kMiB); });
  int wrong = 0;
  for_each_mib([&](const unsigned char* block, int value) {
    wrong += block[0] == value && std::memcmp(block, block + 1, kMiB - 1) == 0 ? 0 : 1;
  });
  CHECK(wrong == 0);
  CHECK(most < static_cast<std::size_t>(kLeast));
  CHECK(most > static_cast<std::size_t>(kLeast) / 2);  // what there is may be used
}
#endif

TEST_CASE("memory: limits out of range and folders that cannot be used are refused by name") {
  const auto make = [](std::int64_t bytes, const std::string& folder) { Memory memory({bytes, folder}); };
  expect_error(ErrorCode::kInvalidArgument, {"1000 bytes", "134217728"}, [&] { make(1000, ""); });
  expect_error(ErrorCode::kInvalidArgument, {"-1 bytes"}, [&] { make(-1, ""); });
  expect_error(ErrorCode::kInvalidArgument, {"image_share", "0.5"}, [&] { Memory memory({kLeast, "", 0.5}); });
  expect_error(ErrorCode::kIo, {"no folder", "/nowhere"}, [&] { make(kLeast, "/nowhere"); });
  expect_error(ErrorCode::kIo, {"no folder", "/dev/null"}, [&] { make(kLeast, "/dev/null"); });
  expect_error(ErrorCode::kIo, {"'/proc' takes no file", "--scratch"}, [&] {
    Memory memory({kLeast, "/proc", 0.0});
    (void)memory.allocate(kMiB);
  });
}

TEST_CASE("memory: a full disk is told with the bytes that it lacks") {
  const TemporaryFolder folder;
  Memory memory({kLeast, folder.path().string(), 0.0});
  const FileSizeLimit limit(kMiB);
  expect_error(ErrorCode::kIo, {folder.path().string(), "no room for 2097152 bytes", "--scratch"},
               [&] { (void)memory.allocate(2 * kMiB); });
  CHECK(memory.usage().scratch_bytes == 0);
  CHECK(memory.allocate(kMiB / 2) != nullptr);
}

}  // namespace stein
