// SPDX-License-Identifier: Apache-2.0
#include "pipeline/external_picture.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "core/parameter_check.hpp"
#include "core/validity.hpp"
#include "pipeline/mixture.hpp"
#include "pipeline/second_pass.hpp"
#include "prefilter/perturbed_frame.hpp"
#include "risk/followed.hpp"
#include "risk/sure.hpp"
#include "stein/error.hpp"

namespace stein {
namespace {

using Image = std::array<ConstPlaneView, 3>;

[[noreturn]] void refuse(const ExternalCandidate& candidate, const std::string& what) {
  throw Error(ErrorCode::kInvalidArgument, "the candidate '" + candidate.name + "': " + what);
}

// What it made of one frame, with the memory where that is the library's.
struct Answer {
  std::array<Plane, 3> memory;
  Image image;
};

Layer as_layer(const ExternalCandidate& candidate, const Image& image) {
  return {candidate.name, {image.begin(), image.end()}};
}

int layer_channels(const Frame& frame) {
  int channels = 0;
  for (const Layer& layer : frame.layers) channels += static_cast<int>(layer.mean.size());
  return channels;
}

class Pictures {
 public:
  Pictures(const Source& given, const ExternalCandidate& candidate, exec::Runner& runner, double progress_weight)
      : given_(given),
        frame_(given.frame()),
        candidate_(candidate),
        runner_(runner),
        share_(progress_weight / (1 + draws_of(candidate))),
        rows_(MixtureRows::planes(layer_channels(frame_)), frame_.width, frame_.height, given.memory(),
              Memory::Use::kImage),
        out_(rows_),
        lines_(static_cast<std::size_t>(runner.slots()),
               std::vector<float>(6 * static_cast<std::size_t>(frame_.width))) {}

  exec::RowRing make(std::vector<std::string>& warnings) {
    take_image(answer(nullptr).image);
    if (layer_channels(frame_) > 0) take_layers(std::get<ExternalImages>(candidate_.source).layers);
    bool is_still = false;
    for (int draw = 0; draw < draws_of(candidate_); ++draw) {
      const Perturbation perturbation = perturbation_of(draw);
      const Followed followed =
          add_draw(answer(&perturbation, draw).image, given_.perturbed(perturbation), perturbation.step);
      if (candidate_.name == kSecondPass) continue;  // stein's own, of the right frame by construction
      if (followed.is_by_chance()) refuse_chance(perturbation);
      is_still = is_still || followed.is_still();
    }
    if (is_still) warn_of_stillness(warnings);
    return std::move(rows_);
  }

 private:
  [[nodiscard]] Perturbation perturbation_of(int draw) const {
    if (const auto* denoiser = std::get_if<ExternalDenoiser>(&candidate_.source))
      return {denoiser->seed, draw, denoiser->step};
    return std::get<ExternalImages>(candidate_.source).draws[static_cast<std::size_t>(draw)].perturbation;
  }

  // Of the frame as it is, or perturbed.
  Answer answer(const Perturbation* perturbation, int draw = 0) {
    runner_.for_each(1, 0.0, [](int, int) {});  // whether to go on
    Answer out;
    if (const auto* images = std::get_if<ExternalImages>(&candidate_.source)) {
      out.image = perturbation == nullptr ? images->image : images->draws[static_cast<std::size_t>(draw)].image;
    } else {
      const auto& run = std::get<ExternalDenoiser>(candidate_.source).run;
      std::vector<Plane> moved;
      out.memory = run(perturbation == nullptr ? frame_ : perturbed_frame(given_, *perturbation, runner_, moved));
      for (std::size_t c = 0; c < 3; ++c) out.image[c] = std::as_const(out.memory[c]).view();
    }
    require_usable(out.image, perturbation != nullptr);
    return out;
  }

  void require_usable(const Image& image, bool is_perturbed) const {
    const std::string which = is_perturbed ? "its image of a perturbed frame " : "its image ";
    for (const ConstPlaneView& plane : image) {
      if (plane && plane.width() == frame_.width && plane.height() == frame_.height) continue;
      refuse(candidate_, which + "has " + std::to_string(plane.width()) + "x" + std::to_string(plane.height()) +
                             " pixels, the frame " + std::to_string(frame_.width) + "x" +
                             std::to_string(frame_.height) + "; it must be of the same frame");
    }
    std::vector<int> first_bad(static_cast<std::size_t>(frame_.height), -1);  // per row
    runner_.for_each(frame_.height, 0.0, [&](int y, int) {
      std::vector<float> usable(2 * static_cast<std::size_t>(frame_.width));
      float* both = usable.data() + frame_.width;
      colour_validity_row(frame_, y, 0, frame_.width, usable.data());
      if (layer_validity_row(frame_, as_layer(candidate_, image), y, 0, frame_.width, both) == 0) return;
      for (int x = frame_.width - 1; x >= 0; --x) {
        if (usable[static_cast<std::size_t>(x)] != both[x]) first_bad[static_cast<std::size_t>(y)] = x;
      }
    });
    for (int y = 0; y < frame_.height; ++y) {
      const int x = first_bad[static_cast<std::size_t>(y)];
      if (x < 0) continue;
      refuse(candidate_, which + "is no colour at pixel (" + std::to_string(x) + ", " + std::to_string(y) +
                             "), where the frame is; mend it, or leave the candidate out");
    }
  }

  void take_image(const Image& image) {
    ReplacedPixels filled;
    // One with layers is whole, as they are: filled by itself it would not be their sum.
    if (layer_channels(frame_) == 0 && std::any_of(given_.replaced().list().begin(), given_.replaced().list().end(),
                                                   [](const ReplacedPixel& p) { return !p.is_source; })) {
      filled.add(fill_layer(frame_, as_layer(candidate_, image), given_.memory()), frame_.height);
    }
    runner_.for_each(frame_.height, share_, [&](int y, int) {
      for (std::size_t c = 0; c < 3; ++c) {
        float* F = out_.result(static_cast<int>(c), y);
        image[c].read_row(y, 0, frame_.width, F);
        filled.for_each(y, 0, frame_.width, [&](const ReplacedPixel& p, int i) { F[i] = p.colour[c]; });
      }
    });
  }

  void take_layers(const std::vector<ConstPlaneView>& layers) {
    for (std::size_t c = 0; c < layers.size(); ++c) {
      if (layers[c].width() != frame_.width || layers[c].height() != frame_.height)
        refuse(candidate_, "its layers are not of the frame's size");
    }
    runner_.for_each(frame_.height, 0.0, [&](int y, int) {
      for (std::size_t c = 0; c < layers.size(); ++c) {
        float* row = out_.layer(static_cast<int>(c), y);
        layers[c].read_row(y, 0, frame_.width, row);
        if (!std::all_of(row, row + frame_.width, [](float v) { return std::isfinite(v); }))
          refuse(candidate_, "its layers hold what is no number in row " + std::to_string(y));
      }
    });
  }

  // As FilterRuns::add_draw.
  Followed add_draw(const Image& image, const Source& moved, float step) {
    const float factor = 1.0F / (step * static_cast<float>(draws_of(candidate_)));
    std::vector<Followed> rows(static_cast<std::size_t>(frame_.height));
    runner_.for_each(frame_.height, share_, [&](int y, int slot) {
      const std::ptrdiff_t width = frame_.width;
      float* const lines = lines_[static_cast<std::size_t>(slot)].data();
      float* b[3] = {lines, lines + width, lines + 2 * width};
      float* F_moved[3] = {lines + 3 * width, lines + 4 * width, lines + 5 * width};
      const float* F[3];
      moved.direction_rows(y, 0, frame_.width, b);
      for (int c = 0; c < 3; ++c) {
        F[c] = out_.result(c, y);
        image[static_cast<std::size_t>(c)].read_row(y, 0, frame_.width, F_moved[c]);
        // An unusable pixel does not move.
        add_draw_row(b[c], F_moved[c], F[c], factor, frame_.width, out_.divergence(c, y));
      }
      rows[static_cast<std::size_t>(y)].add_row(b, F, F_moved, step, frame_.width);
    });
    Followed all;
    for (const Followed& row : rows) all.add(row);
    return all;
  }

  [[noreturn]] void refuse_chance(const Perturbation& perturbation) const {
    const std::string draw =
        "draw " + std::to_string(perturbation.draw) + " of seed " + std::to_string(perturbation.seed);
    if (std::holds_alternative<ExternalImages>(candidate_.source)) {
      refuse(candidate_, "its image of a perturbed frame has nothing to do with the perturbation: it was not made of " +
                             draw + " of this frame; perturb anew, and give the images in the order of their draws");
    }
    refuse(candidate_, "what it makes of " + draw +
                           " has nothing to do with the perturbation; it has to denoise the frame that it is handed, "
                           "and to do the same for the same");
  }

  void warn_of_stillness(std::vector<std::string>& warnings) const {
    warnings.push_back("the candidate '" + candidate_.name +
                       "' does not change with the frame, and is taken to have none of its noise; if it is a "
                       "denoiser's image, have it denoise the perturbed frame");
  }

  const Source& given_;
  const Frame& frame_;
  const ExternalCandidate& candidate_;
  exec::Runner& runner_;
  double share_;
  exec::RowRing rows_;
  MixtureRows out_;
  std::vector<std::vector<float>> lines_;  // per slot
};

}  // namespace

int draws_of(const ExternalCandidate& candidate) noexcept {
  if (const auto* denoiser = std::get_if<ExternalDenoiser>(&candidate.source)) return denoiser->draws;
  return static_cast<int>(std::get<ExternalImages>(candidate.source).draws.size());
}

exec::RowRing external_picture(const Source& given, const ExternalCandidate& candidate, exec::Runner& runner,
                               double progress_weight, std::vector<std::string>& warnings) {
  return Pictures(given, candidate, runner, progress_weight).make(warnings);
}

void check(const ExternalCandidate& candidate) {
  constexpr float kMostDraws = 16.0F;
  if (candidate.name.empty()) throw Error(ErrorCode::kInvalidArgument, "an external candidate has no name; give one");
  const std::string draws = "the number of perturbed runs of the candidate '" + candidate.name + "'";
  require_in_range(draws, static_cast<float>(draws_of(candidate)), 1.0F, kMostDraws);
  if (const auto* denoiser = std::get_if<ExternalDenoiser>(&candidate.source)) {
    if (!denoiser->run) refuse(candidate, "it has no function to run");
    check(Perturbation{denoiser->seed, 0, denoiser->step});
  } else {
    for (const ExternalDraw& draw : std::get<ExternalImages>(candidate.source).draws) check(draw.perturbation);
  }
}

void check_candidates(const DenoiseParams& params) {
  const std::size_t pictures = params.filters.size() + params.candidates.size() + (params.second_pass ? 1 : 0);
  require_in_range("the number of filters and external candidates", static_cast<float>(pictures), 1.0F, kMaxFilters);
  std::set<std::string> names;
  for (const FilterSpec& filter : params.filters) names.emplace(filter_name(filter));
  if (params.second_pass) names.insert(kSecondPass);
  for (const ExternalCandidate& candidate : params.candidates) {
    check(candidate);
    if (names.insert(candidate.name).second) continue;
    throw Error(ErrorCode::kInvalidArgument, "an external candidate and a filter, or another candidate, are called '" +
                                                 candidate.name + "'; give each a name of its own");
  }
}

void require_layers(const Frame& frame, const DenoiseParams& params) {
  const auto channels = static_cast<std::size_t>(layer_channels(frame));
  for (const ExternalCandidate& candidate : params.candidates) {
    const auto* images = std::get_if<ExternalImages>(&candidate.source);
    if ((images != nullptr ? images->layers.size() : 0) == channels) continue;
    if (channels == 0) refuse(candidate, "it has layers, which the frame has not");
    throw Error(ErrorCode::kInvalidArgument, "the layer '" + frame.layers.front().name +
                                                 "' cannot be filtered as the colour is by the external candidate '" +
                                                 candidate.name + "'; leave out the layers, or the candidate");
  }
}

}  // namespace stein
