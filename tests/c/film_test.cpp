// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "c/scene.hpp"
#include "stein/accumulate.hpp"
#include "stein/denoise.hpp"

namespace stein::test {
namespace {

constexpr int kWidth = 20;
constexpr int kHeight = 12;
constexpr std::array<const char*, 2> kNames = {"albedo", "depth"};
constexpr std::array<int32_t, 2> kChannels = {3, 1};

Handle<stein_film> make_film() {
  return made<stein_film>(
      [](stein_film** f) { return stein_film_create(kWidth, kHeight, kNames.data(), kChannels.data(), 2, f); });
}

// Samples of R, G, B, albedo and depth; the same for every film of the same seed.
template <class Add>
void render(unsigned seed, const Add& add) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  for (int i = 0; i < 4 * kWidth * kHeight; ++i) {
    std::array<float, 7> sample{};
    for (float& v : sample) v = uniform(random);
    add(i % kWidth, i / kWidth % kHeight, sample.data());
  }
}

double number(const stein_film* film, const char* name) {
  double value = -1;
  REQUIRE(stein_film_number(film, name, &value) == STEIN_OK);
  return value;
}

}  // namespace

TEST_CASE("C: films give the frame that accumulators give") {
  const auto film = make_film();
  const auto other = make_film();
  Accumulator expected(kWidth, kHeight, {.features = {{"albedo", 3}, {"depth", 1}}});
  const auto add_to = [](stein_film* to) {
    return [to](int x, int y, const float* sample) { REQUIRE(stein_film_add(to, x, y, sample) == STEIN_OK); };
  };
  render(1, add_to(film.get()));
  render(2, add_to(other.get()));
  REQUIRE(stein_film_merge(film.get(), other.get()) == STEIN_OK);
  Accumulator second(kWidth, kHeight, expected.layout());
  render(1, [&](int x, int y, const float* sample) { expected.add(x, y, sample); });
  render(2, [&](int x, int y, const float* sample) { second.add(x, y, sample); });
  expected.merge(second);

  auto frame = made<stein_frame>([&](stein_frame** f) { return stein_film_frame(film.get(), f); });
  const auto result =
      made<stein_result>([&](stein_result** r) { return stein_denoise(frame.get(), nullptr, nullptr, nullptr, r); });
  const DenoiseResult wanted = denoise(expected.moments().frame());
  std::vector<float> values(std::size_t{kWidth} * kHeight);
  REQUIRE(stein_result_copy(result.get(), "error.B", values.data(), 0, 0) == STEIN_OK);
  for (int y = 0; y < kHeight; ++y)
    REQUIRE(std::equal(wanted.error[2].row(y), wanted.error[2].row(y) + kWidth, values.data() + y * kWidth));
  // A snapshot takes further planes as any other frame.
  CHECK(stein_frame_set_plane(frame.get(), "albedo.R", STEIN_FLOAT32, values.data(), 0, 0) == STEIN_OK);
}

TEST_CASE("C: films count what they refuse and repair") {
  const auto film = make_film();
  std::array<float, 7> sample = {1, NAN, 1, 1, 1, 1, 1};
  REQUIRE(stein_film_add(film.get(), 0, 0, sample.data()) == STEIN_OK);
  sample = {1, 1, 1, 1, 1, 1, NAN};
  REQUIRE(stein_film_add(film.get(), 0, 0, sample.data()) == STEIN_OK);
  REQUIRE(stein_film_add(film.get(), 1, 0, sample.data()) == STEIN_OK);
  CHECK(number(film.get(), "rejected") == 1);
  CHECK(number(film.get(), "repaired") == 2);
}

TEST_CASE("C: films refuse what cannot be") {
  stein_film* none = nullptr;
  const auto film = make_film();
  const std::array<float, 7> sample{};
  constexpr stein_status kRefused = STEIN_INVALID_ARGUMENT;
  const auto create = [&](int32_t width, const char* const* names, const int32_t* channels, int32_t count) {
    return stein_film_create(width, 4, names, channels, count, &none);
  };
  check_failure(create(0, nullptr, nullptr, 0), kRefused, {"0x4"});
  check_failure(create(4, nullptr, kChannels.data(), 2), kRefused, {"names is null"});
  check_failure(create(4, kNames.data(), nullptr, 2), kRefused, {"channels is null"});
  check_failure(create(4, kNames.data(), kChannels.data(), -1), kRefused, {"-1"});
  const std::array<const char*, 2> twice = {"depth", "depth"};
  check_failure(create(4, twice.data(), kChannels.data(), 2), kRefused, {"'depth'", "unique"});
  const std::array<const char*, 1> dotted = {"a.b"};
  check_failure(create(4, dotted.data(), kChannels.data(), 1), kRefused, {"'a.b'", "dot"});
  check_failure(stein_film_create(4, 4, nullptr, nullptr, 0, nullptr), kRefused, {"null"});
  CHECK(none == nullptr);
  for (const auto& [x, y] : {std::pair{-1, 0}, {0, -1}, {kWidth, 0}, {0, kHeight}}) {
    const std::string pixel = "(" + std::to_string(x) + ", " + std::to_string(y) + ")";
    check_failure(stein_film_add(film.get(), x, y, sample.data()), kRefused, {pixel, "20x12"});
  }
  check_failure(stein_film_add(nullptr, 0, 0, sample.data()), kRefused, {"the film is null"});
  check_failure(stein_film_add(film.get(), 0, 0, nullptr), kRefused, {"the sample is null"});
  REQUIRE(create(4, nullptr, nullptr, 0) == STEIN_OK);
  const Handle<stein_film> small(none);
  check_failure(stein_film_merge(film.get(), small.get()), kRefused, {"4x4", "20x12"});
  check_failure(stein_film_merge(film.get(), film.get()), kRefused, {"same"});
  check_failure(stein_film_merge(nullptr, film.get()), kRefused, {"the film is null"});
  check_failure(stein_film_merge(film.get(), nullptr), kRefused, {"the other film is null"});
  double value = 0;
  check_failure(stein_film_number(film.get(), "lost", &value), kRefused, {"'lost'", "rejected"});
  stein_frame* frame = nullptr;
  check_failure(stein_film_frame(nullptr, &frame), kRefused, {"the film is null"});
}

}  // namespace stein::test
