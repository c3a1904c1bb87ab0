// SPDX-License-Identifier: Apache-2.0
//
// Images of other denoisers among the filters' own.
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "pipeline/external_picture.hpp"
#include "pipeline/mixture.hpp"
#include "stein/adaptive.hpp"
#include "stein/denoise.hpp"
#include "stein/error.hpp"
#include "support/noisy_scene.hpp"
#include "support/same_bits.hpp"

namespace stein::test {
namespace {

using Image = std::array<Plane, 3>;

template <class Value>
Image image_of(int width, int height, const Value& value) {
  Image image = Plane::triple(width, height);
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) image[c].row(y)[x] = static_cast<float>(value(c, x, y));
    }
  }
  return image;
}

// The mean of the 3x3 neighbourhood, cut at the border: linear, so that its divergence is known.
int count_in_reach(const Frame& frame, int x, int y) {
  const int columns = std::min(x + 1, frame.width - 1) - std::max(x - 1, 0) + 1;
  const int rows = std::min(y + 1, frame.height - 1) - std::max(y - 1, 0) + 1;
  return columns * rows;
}

Image box(const Frame& frame) {
  return image_of(frame.width, frame.height, [&](std::size_t c, int x, int y) {
    double sum = 0;
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, frame.height - 1); ++v) {
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, frame.width - 1); ++u) sum += frame.colour[c].at(u, v);
    }
    return sum / count_in_reach(frame, x, y);
  });
}

ExternalCandidate candidate(std::function<Image(const Frame&)> run, int draws = 1) {
  return {"other", ExternalDenoiser{.run = std::move(run), .draws = draws}};
}

DenoiseParams params_with(std::vector<ExternalCandidate> candidates) {
  DenoiseParams params;
  CrossBilateralParams filter;
  filter.spatial_sigmas = {1.0F, 2.0F};
  params.filters = {filter};
  params.candidates = std::move(candidates);
  return params;
}

std::array<ConstPlaneView, 3> views(const Image& planes) {
  return {planes[0].view(), planes[1].view(), planes[2].view()};
}

template <class Truth>
double relative_error(const DenoiseResult& result, const Truth& truth) {
  const Plane& plane = result.colour[0];
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < plane.height(); ++y) {
      for (int x = 0; x < plane.width(); ++x) {
        const double wanted = truth(c, x, y);
        sum += std::pow(result.colour[c].row(y)[x] - wanted, 2) / (wanted * wanted + 0.01);
      }
    }
  }
  return sum / (3.0 * plane.width() * plane.height());
}

double relative_error(const NoisyScene& scene, const DenoiseResult& result) {
  return relative_error(result, [&](std::size_t c, int x, int y) { return scene.truth(c, x, y); });
}

// Nothing where it is not refused.
std::string refusal_of(const Frame& frame, const DenoiseParams& params, ErrorCode code = ErrorCode::kInvalidArgument) {
  try {
    (void)denoise(frame, params);
  } catch (const Error& error) {
    CHECK(error.code() == code);
    return error.what();
  }
  return {};
}

std::string refusal(const Frame& frame, const DenoiseParams& params, ErrorCode code = ErrorCode::kInvalidArgument) {
  const std::string message = refusal_of(frame, params, code);
  REQUIRE(!message.empty());
  return message;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("external: the divergence of a linear filter is its weight of the pixel times the variance") {
  OwnedFrame owned(48, 40, kUsualFeatures);
  fill_random(owned, 12);
  const Frame& frame = owned.frame();
  const Source source(frame, inspect(frame));
  exec::Runner runner(Execution{});
  constexpr int kDraws = 16;
  std::vector<std::string> warnings;
  const exec::RowRing rows = external_picture(source, candidate(box, kDraws), runner, 0.0, warnings);
  CHECK(warnings.empty());
  const MixtureRows picture(rows);
  const Image F = box(frame);
  // Every draw's term has a mean of v / n, and from the eight neighbours b_p sum b_q / n a standard deviation of about
  // sqrt(8) v / n where the neighbours are as noisy.
  for (int c = 0; c < 3; ++c) {
    double sum = 0;
    double expected = 0;
    double noise = 0;
    for (int y = 0; y < frame.height; ++y) {
      for (int x = 0; x < frame.width; ++x) {
        const auto i = static_cast<std::size_t>(c);
        CHECK(picture.result(c, y)[x] == F[i].row(y)[x]);
        const double count = count_in_reach(frame, x, y);
        double others = 0;
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, frame.height - 1); ++v) {
          for (int u = std::max(x - 1, 0); u <= std::min(x + 1, frame.width - 1); ++u)
            if (u != x || v != y) others += frame.colour_variance[i].at(u, v);
        }
        const double own = frame.colour_variance[i].at(x, y);
        sum += picture.divergence(c, y)[x];
        expected += own / count;
        noise += own * others / (count * count * kDraws);
      }
    }
    CAPTURE(sum, expected, noise);
    // Pairs of neighbours come twice, with the same product of signs.
    CHECK(std::abs(sum - expected) < 4.0 * std::sqrt(2.0 * noise) + 1e-3 * expected);
    CHECK(4.0 * std::sqrt(2.0 * noise) < 0.3 * expected);
  }
}

TEST_CASE("external: given images and a function give the same bits") {
  NoisyScene scene({});
  scene.draw();
  const Frame& frame = scene.frame();
  const Image image = box(frame);
  const Perturbation first{1, 0, kExternalStep};
  const Perturbation second{1, 1, kExternalStep};
  const PerturbedFrame frame_of_first(frame, first);
  const PerturbedFrame frame_of_second(frame, second);
  const Image moved = box(frame_of_first.frame());
  const Image moved_again = box(frame_of_second.frame());
  const ExternalImages images{views(image), {{first, views(moved)}, {second, views(moved_again)}}};
  const DenoiseResult by_images = denoise(frame, params_with({{"other", images}}));
  DenoiseParams params = params_with({candidate(box, 2)});
  for (const auto& [threads, width] : {std::pair{1, 16}, std::pair{3, 64}}) {
    params.execution.threads = threads;
    params.execution.tile_width = width;
    const DenoiseResult by_function = denoise(frame, params);
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK(same_bits(by_images.colour[c], by_function.colour[c]));
      CHECK(same_bits(by_images.error[c], by_function.error[c]));
    }
    CHECK(same_bits(by_images.choice, by_function.choice));
  }
}

TEST_CASE("external: the truth gets nearly all weight, and the result is nearly it") {
  NoisyScene scene({});
  scene.draw();
  const auto truth = [&](const Frame& frame) {
    return image_of(frame.width, frame.height, [&](std::size_t c, int x, int y) { return scene.truth(c, x, y); });
  };
  const DenoiseResult without = denoise(scene.frame(), params_with({}));
  const DenoiseResult with = denoise(scene.frame(), params_with({candidate(truth)}));
  CHECK(with.report.filters.back().weight > 0.85);
  CHECK(relative_error(scene, with) < 0.1 * relative_error(scene, without));
}

TEST_CASE("external: what is wrong changes nothing") {
  NoisyScene scene({});
  scene.draw();
  const int width = scene.width();
  const auto truth = [&](std::size_t c, int x, int y) { return scene.truth(c, x, y); };
  const std::vector<std::pair<std::string, std::function<double(std::size_t, int, int)>>> wrong = {
      {"constant", [](std::size_t, int, int) { return 5.0; }},
      {"black", [](std::size_t, int, int) { return 0.0; }},
      {"shifted", [&](std::size_t c, int x, int y) { return truth(c, (x + width / 2) % width, y); }},
      {"three times as bright", [&](std::size_t c, int x, int y) { return 3.0 * truth(c, x, y); }},
      {"huge", [](std::size_t, int x, int) { return x % 2 == 0 ? 1e15 : -1e15; }},
  };
  const DenoiseResult without = denoise(scene.frame(), params_with({}));
  for (const auto& [what, value] : wrong) {
    INFO(what);
    const auto run = [&value = value](const Frame& frame) { return image_of(frame.width, frame.height, value); };
    const DenoiseResult with = denoise(scene.frame(), params_with({candidate(run)}));
    CHECK(with.report.filters.back().weight < 0.01);
    CHECK(relative_error(scene, with) < 1.02 * relative_error(scene, without));
  }
}

TEST_CASE("external: one that is right in a part of the image has its weight there") {
  constexpr int kWidth = 640;
  constexpr int kHeight = 32;
  OwnedFrame owned(kWidth, kHeight, kUsualFeatures);
  fill_random(owned, 3);
  Random random(17);
  const auto truth = [](std::size_t c, int x, int y) {
    return 0.5 + 0.3 * std::sin(0.9 * x + static_cast<double>(c)) * std::cos(0.7 * y);
  };
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        owned.at(std::string(1, "RGB"[c]), x, y) = static_cast<float>(truth(c, x, y) + 0.2 * random.normal());
        owned.at(std::string("variance.") + "RGB"[c], x, y) = 0.04F;
      }
    }
  }
  owned.frame().colour_covariance = {};
  for (Feature& feature : owned.frame().features) feature.colour_covariance.clear();
  const auto right_at_left = [&](const Frame& frame) {
    return image_of(frame.width, frame.height,
                    [&](std::size_t c, int x, int y) { return x < kWidth / 2 ? truth(c, x, y) : 7.0; });
  };
  const DenoiseResult result = denoise(owned.frame(), params_with({candidate(right_at_left)}));
  const auto last = static_cast<float>(result.report.candidates.size() - 1);
  const int far = 100;  // from the middle, where neither side speaks of the other
  double left = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth / 2 - far; ++x) {
      left += result.choice.row(y)[x] == last ? 1.0 : 0.0;
    }
    for (int x = kWidth / 2 + 16; x < kWidth; ++x) CHECK(result.choice.row(y)[x] != last);
  }
  CHECK(left > 0.9 * kHeight * (kWidth / 2 - far));
}

TEST_CASE("external: report, choice and progress speak of it") {
  NoisyScene scene({});
  scene.draw();
  DenoiseParams params = params_with({candidate(box), {"twin", ExternalDenoiser{.run = box, .draws = 2}}});
  double last = 0;
  params.execution.progress = [&last](double done) {
    CHECK(done >= last);
    last = done;
    return true;
  };
  const DenoiseReport report = denoise(scene.frame(), params).report;
  CHECK(report.candidates == std::vector<std::string>{"input", "sigma_s=1", "sigma_s=2", "other", "twin"});
  REQUIRE(report.filters.size() == 3);
  CHECK(report.filters[1].name == "other");
  CHECK(report.filters[1].risk == "Monte Carlo joint SURE");
  CHECK(report.filters[1].risk_reason == "from 1 perturbed run");
  CHECK(report.filters[2].risk_reason == "from 2 perturbed runs");
  CHECK(std::accumulate(report.choice_share.begin(), report.choice_share.end(), 0.0) == Approx(1.0));
  CHECK(last == Approx(1.0));
}

TEST_CASE("external: one that does not follow the perturbation is refused, if the image can show it") {
  constexpr int kSide = 128;
  OwnedFrame owned(kSide, kSide, kUsualFeatures);
  fill_random(owned, 13);
  const Frame& frame = owned.frame();
  const auto answers = [&](const auto& run, const Perturbation& perturbation) {
    return run(PerturbedFrame(frame, perturbation).frame());
  };
  const auto told = [&](const auto& run, const Perturbation& given, const Perturbation& made_of) {
    const Image image = run(frame);
    const Image moved = answers(run, made_of);
    const ExternalImages images{views(image), {{given, views(moved)}}, {}};
    return refusal_of(frame, params_with({{"other", images}}));
  };
  const Perturbation right{1, 0, kExternalStep};
  CHECK(told(box, right, right).empty());
  for (const Perturbation& other : {Perturbation{1, 1, kExternalStep}, Perturbation{2, 0, kExternalStep}}) {
    const std::string message = told(box, right, other);
    INFO(message);
    for (const char* part : {"'other'", "draw 0 of seed 1 of this frame", "perturb anew"})
      CHECK(contains(message, part));
    const auto row = [](const Frame& given) {
      return image_of(given.width, given.height, [&](std::size_t c, int, int y) {
        double sum = 0;
        for (int x = 0; x < given.width; ++x) sum += given.colour[c].at(x, y);
        return sum / given.width;
      });
    };
    CHECK(contains(told(row, right, other), "draw 0 of seed 1"));
    const auto whole = [](const Frame& given) {  // the image is too small to show that
      double sums[3] = {};
      for (std::size_t c = 0; c < 3; ++c) {
        for (int y = 0; y < given.height; ++y) {
          for (int x = 0; x < given.width; ++x) sums[c] += given.colour[c].at(x, y);
        }
      }
      return image_of(given.width, given.height,
                      [&](std::size_t c, int, int) { return sums[c] / (given.width * given.height); });
    };
    CHECK(told(whole, right, other).empty());
    const auto input = [](const Frame& given) {
      return image_of(given.width, given.height, [&](std::size_t c, int x, int y) { return given.colour[c].at(x, y); });
    };
    CHECK(contains(told(input, right, other), "draw 0 of seed 1"));
    const auto constant = [](const Frame& given) {
      return image_of(given.width, given.height, [](std::size_t, int, int) { return 0.5; });
    };
    CHECK(told(constant, right, other).empty());
    CHECK(told(constant, right, right).empty());
    CHECK(told(row, right, right).empty());
    CHECK(told(input, right, right).empty());
  }
  // The second of two draws is another one's; and a function that is random.
  const Image image = box(frame);
  const Image moved = answers(box, right);
  const ExternalImages twice{views(image), {{right, views(moved)}, {{1, 1, kExternalStep}, views(moved)}}, {}};
  CHECK(contains(refusal_of(frame, params_with({{"other", twice}})), "draw 1 of seed 1"));
  Random random(3);
  const auto dithered = [&](const Frame& given) {
    return image_of(given.width, given.height,
                    [&](std::size_t c, int x, int y) { return given.colour[c].at(x, y) + 0.5 * random.normal(); });
  };
  const std::string message = refusal_of(frame, params_with({candidate(dithered)}));
  INFO(message);
  CHECK(contains(message, "the same for the same"));
}

TEST_CASE("external: an image that does not change with the frame is taken, with a warning") {
  NoisyScene scene({});
  scene.draw();
  const Image image = box(scene.frame());
  const auto warned = [&](const DenoiseParams& params) {
    const std::vector<std::string> warnings = denoise(scene.frame(), params).report.warnings;
    return std::count_if(warnings.begin(), warnings.end(), [](const std::string& warning) {
      return contains(warning, "'other' does not change with the frame");
    });
  };
  const Perturbation first{1, 0, kExternalStep};
  const Perturbation second{1, 1, kExternalStep};
  const Image moved = box(PerturbedFrame(scene.frame(), first).frame());
  const ExternalImages same{views(image), {{first, views(image)}, {second, views(image)}}, {}};
  CHECK(warned(params_with({{"other", same}})) == 1);
  const ExternalImages half{views(image), {{first, views(moved)}, {second, views(image)}}, {}};
  CHECK(warned(params_with({{"other", half}})) == 1);
  CHECK(warned(params_with({candidate(box)})) == 0);
}

TEST_CASE("external: of each picture the error that it has more than the mixture") {
  NoisyScene scene({});
  scene.draw();
  Frame frame = scene.frame();
  const Image colour = image_of(frame.width, frame.height, [&](std::size_t c, int x, int y) {
    return x == 9 && y == 7 ? 1e4 : frame.colour[c].at(x, y);  // an outlier, whose energy is given back
  });
  for (std::size_t c = 0; c < 3; ++c) frame.colour[c] = colour[c].view();
  DenoiseParams params = params_with({candidate(box)});
  const DenoiseResult result = denoise(frame, params);
  REQUIRE(result.report.outlier_pixels > 0);
  DenoiseParams alone = params;
  alone.candidates.clear();
  const DenoiseResult own = denoise(frame, alone);
  const Image other = box(frame);
  double more[2] = {};
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < frame.height; ++y) {
      for (int x = 0; x < frame.width; ++x) {
        const double B = result.colour[c].row(y)[x];
        const double weight = 1.0 / (B * B + 0.01) / (3.0 * frame.width * frame.height);
        more[0] += weight * std::pow(own.colour[c].row(y)[x] - B, 2);
        more[1] += weight * std::pow(other[c].row(y)[x] - B, 2);
      }
    }
  }
  const DenoiseReport& report = result.report;
  REQUIRE(report.filters.size() == 2);
  for (std::size_t f = 0; f < 2; ++f)
    CHECK(report.filters[f].mean_relative_error.value() == Approx(report.mean_relative_error + more[f]).epsilon(1e-4));
  CHECK(own.report.filters[0].mean_relative_error.value() == own.report.mean_relative_error);
  params.strength = 0.5F;
  for (const FilterShare& filter : denoise(frame, params).report.filters) CHECK(!filter.mean_relative_error);
  alone.strength = 0.5F;
  CHECK(!denoise(frame, alone).report.filters[0].mean_relative_error);
}

// With noise that is small beside the colour, so that weights by the picture and by the truth are the same.
TEST_CASE("external: what is told of each picture's error is its error") {
  constexpr int kWidth = 96;
  constexpr int kHeight = 64;
  constexpr int kDraws = 20;
  const auto truth = [](std::size_t c, int x, int y) {
    return 1.5 + 0.3 * std::sin(0.9 * x + static_cast<double>(c)) * std::cos(0.2 * y);
  };
  Random random(19);
  double told[2] = {};
  double true_errors[2] = {};
  for (int draw = 0; draw < kDraws; ++draw) {
    OwnedFrame owned(kWidth, kHeight, {}, false);
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          owned.at(std::string(1, "RGB"[c]), x, y) = static_cast<float>(truth(c, x, y) + 0.2 * random.normal());
          owned.at(std::string("variance.") + "RGB"[c], x, y) = 0.04F;
        }
      }
    }
    const Frame& frame = owned.frame();
    const DenoiseResult result = denoise(frame, params_with({candidate(box)}));
    DenoiseResult picture = denoise(frame, params_with({}));
    for (std::size_t f = 0; f < 2; ++f) {
      told[f] += result.report.filters[f].mean_relative_error.value() / kDraws;
      true_errors[f] += relative_error(picture, truth) / kDraws;
      picture.colour = box(frame);
    }
  }
  for (std::size_t f = 0; f < 2; ++f) {
    INFO("picture " << f << ": told " << told[f] << ", true " << true_errors[f]);
    CHECK(told[f] == Approx(true_errors[f]).epsilon(0.05));
  }
}

TEST_CASE("external: it sees unusable values as they are, and may leave them") {
  NoisyScene scene({});
  scene.draw();
  Frame frame = scene.frame();
  const Image colour = image_of(frame.width, frame.height, [&](std::size_t c, int x, int y) {
    return x == 5 && y == 6 ? std::numeric_limits<double>::quiet_NaN() : frame.colour[c].at(x, y);
  });
  for (std::size_t c = 0; c < 3; ++c) frame.colour[c] = colour[c].view();
  int runs = 0;
  const auto run = [&](const Frame& given) {
    ++runs;
    CHECK(std::isnan(given.colour[0].at(5, 6)));
    return image_of(given.width, given.height, [&](std::size_t c, int x, int y) {
      return x == 5 && y == 6 ? std::numeric_limits<double>::quiet_NaN() : scene.truth(c, x, y);
    });
  };
  const DenoiseResult result = denoise(frame, params_with({candidate(run)}));
  CHECK(runs == 2);
  CHECK(result.choice.row(6)[5] == -1.0F);
  for (std::size_t c = 0; c < 3; ++c) CHECK(std::isfinite(result.colour[c].row(6)[5]));
}

TEST_CASE("external: what it throws passes, and cancelling ends between its runs") {
  NoisyScene scene({});
  scene.draw();
  const auto fails = [](const Frame&) -> Image { throw std::domain_error("out of cheese"); };
  CHECK_THROWS_AS(denoise(scene.frame(), params_with({candidate(fails)})), std::domain_error);

  int runs = 0;
  DenoiseParams params = params_with({candidate(
      [&](const Frame& frame) {
        ++runs;
        return box(frame);
      },
      16)});
  params.execution.progress = [&](double) { return runs < 2; };
  CHECK(contains(refusal(scene.frame(), params, ErrorCode::kCancelled), "cancelled"));
  CHECK(runs == 2);
}

TEST_CASE("external: images that cannot be of the frame are refused by name") {
  NoisyScene scene({});
  scene.draw();
  const Frame& frame = scene.frame();
  const auto small = [](const Frame& given) { return box(given).size() == 3 ? Plane::triple(2, 3) : Image(); };
  const std::string size = refusal(frame, params_with({candidate(small)}));
  CHECK(contains(size, "'other'"));
  CHECK(contains(size, "2x3"));
  CHECK(contains(refusal(frame, params_with({candidate([](const Frame&) { return Image(); })})), "0x0"));
  int run = 0;
  const auto bad_later = [&run](const Frame& given) {
    Image image = box(given);
    if (++run == 2) image[1].row(4)[3] = std::numeric_limits<float>::quiet_NaN();
    return image;
  };
  const std::string value = refusal(frame, params_with({candidate(bad_later)}));
  CHECK(contains(value, "'other'"));
  CHECK(contains(value, "(3, 4)"));
  CHECK(contains(value, "perturbed"));
}

TEST_CASE("external: candidates that cannot be are refused before any work") {
  NoisyScene scene({});
  const Frame& frame = scene.frame();
  int runs = 0;
  const auto counted = [&runs](const Frame& given) {
    ++runs;
    return box(given);
  };
  ExternalDenoiser denoiser{.run = counted};
  const auto refused = [&](ExternalCandidate wrong) { return refusal(frame, params_with({std::move(wrong)})); };
  CHECK(contains(refused({"", denoiser}), "no name"));
  CHECK(contains(refused({"x", ExternalDenoiser{}}), "no function"));
  CHECK(contains(refused({"x", ExternalImages{}}), "perturbed runs of the candidate 'x'"));
  denoiser.draws = 17;
  CHECK(contains(refused({"x", denoiser}), "17"));
  denoiser.draws = 1;
  denoiser.step = 3;
  CHECK(contains(refused({"x", denoiser}), "step"));
  denoiser.step = kExternalStep;
  CHECK(contains(refusal(frame, params_with({{"x", denoiser}, {"x", denoiser}})), "called 'x'"));
  CHECK(contains(refusal(frame, params_with({{"cross-bilateral", denoiser}})), "called 'cross-bilateral'"));
  std::vector<ExternalCandidate> many;
  for (int i = 0; i < kMaxFilters; ++i) many.push_back({std::to_string(i), denoiser});
  CHECK(contains(refusal(frame, params_with(many)), "filters and external candidates"));
  Frame layered = frame;
  layered.layers.push_back({"key", {frame.colour.begin(), frame.colour.end()}});
  CHECK(contains(refusal(layered, params_with({{"x", denoiser}})), "'key'"));
  AdaptiveParams adaptive;
  adaptive.budget = 1 << 20;
  adaptive.denoise = params_with({{"x", ExternalImages{{}, {ExternalDraw{}}}}});
  CHECK_THROWS_AS(denoise_adaptively(
                      frame.width, frame.height, [&](const auto&) { return frame; }, adaptive),
                  Error);
  CHECK(runs == 0);
}

}  // namespace stein::test
