// SPDX-License-Identifier: Apache-2.0
//
// Reading and writing tell how far they are, and can be stopped between any two chunks.
#include <algorithm>

#include "catch.hpp"
#include "expect_error.hpp"
#include "fixture.hpp"

namespace fixture {

using stein::DenoiseResult;
using stein::ErrorCode;
using stein::exr::LoadedFrame;
using stein::exr::read_frame;
using stein::exr::write_result;

namespace {

constexpr int kRows = 400;
constexpr int kChunks = kRows / 16;  // of ZIP

void write_input(const TemporaryFolder& folder) {
  write_file(folder / "in.exr", {{"main", native_channels(), {0, 0, 63, kRows - 1}},
                                 {"other", fixture::layer("other", "XYZ", Imf::FLOAT), {0, 0, 63, kRows - 1}}});
}

/// What a callback was told; it cancels at the call of that number.
struct Listener {
  int cancel_at = -1;
  std::vector<double> told{};

  [[nodiscard]] std::function<bool(double)> callback() {
    return [this](double fraction) {
      told.push_back(fraction);
      return static_cast<int>(told.size()) != cancel_at;
    };
  }
  [[nodiscard]] int calls() const { return static_cast<int>(told.size()); }
};

void check_progress(const Listener& listener) {
  CHECK(listener.calls() >= kChunks);
  CHECK(std::is_sorted(listener.told.begin(), listener.told.end()));
  CHECK(listener.told.front() >= 0);
  CHECK(listener.told.back() <= 1);
  CHECK(listener.told.back() > 0.5);
}

}  // namespace

TEST_CASE("reading is told chunk by chunk, and stops where it is cancelled") {
  const TemporaryFolder folder;
  write_input(folder);
  Listener whole;
  CHECK(read_frame(folder / "in.exr", {.progress = whole.callback()}).frame().height == kRows);
  check_progress(whole);
  for (const int at : {1, 2, whole.calls() / 2, whole.calls()}) {
    Listener listener{at};
    expect_error(ErrorCode::kCancelled, {"cancelled"},
                 [&] { static_cast<void>(read_frame(folder / "in.exr", {.progress = listener.callback()})); });
    CHECK(listener.calls() == at);
  }
}

TEST_CASE("writing is told chunk by chunk, and leaves nothing where it is cancelled") {
  const TemporaryFolder folder;
  write_input(folder);
  const LoadedFrame source = read_frame(folder / "in.exr");
  const DenoiseResult result = result_for(source.frame());
  Listener whole;
  write_result(folder / "whole.exr", source, result, {.progress = whole.callback()});
  check_progress(whole);
  // The last calls come from a destructor, which cannot throw.
  for (const int at : {1, 2, whole.calls() / 2, whole.calls() - 1, whole.calls()}) {
    Listener listener{at};
    expect_error(ErrorCode::kCancelled, {"cancelled"},
                 [&] { write_result(folder / "out.exr", source, result, {.progress = listener.callback()}); });
    CHECK(listener.calls() == at);
    CHECK(folder.names() == std::vector<std::string>{"in.exr", "whole.exr"});
  }
}

}  // namespace fixture
