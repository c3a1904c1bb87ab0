// SPDX-License-Identifier: Apache-2.0
//
// RPF: Sen, Darabi, "On Filtering the Noise from the Random Parameters in Monte Carlo Rendering", 2012.
// Its Algorithm 1 as a chain of passes that follow each other down the image.
#include "stein/rpf.hpp"

#include <algorithm>
#include <memory>
#include <numeric>
#include <optional>
#include <string>

#include "core/memory_warnings.hpp"
#include "exec/runner.hpp"
#include "rpf/error_rows.hpp"
#include "rpf/light_return.hpp"
#include "rpf/pixel_filter.hpp"
#include "stein/error.hpp"

namespace stein {
namespace {

using rpf::ErrorRows;
using rpf::LightReturn;
using rpf::PixelFilter;
using rpf::RecordLayout;
using rpf::SampleRows;

constexpr int kBandRows = 16;
constexpr int kTileWidth = LightReturn::kSpan;
constexpr int kTileHeight = 8;

/// One set of samples on its way through the passes: the frame's, those of a frame beside it, or moved ones.
struct Chain {
  SampleRows rows;
  std::vector<const Chain*> adjacent;  ///< whose samples join the neighbourhoods
  std::vector<int> done;               ///< rows that each stage is through with
};

class RpfRun {
 public:
  RpfRun(const SampleSource& source, const RpfParams& params, const Execution& execution,
         const std::vector<SampleSource>& adjacent);

  RpfReport run(const RpfSink& sink);

 private:
  void add_chain(const SampleSource& source);
  void read_rows(int end);
  void advance(Chain& chain);
  void run_stage(Chain& chain, int stage, int end);
  void run_span(Chain& chain, const std::vector<const SampleRows*>& adjacent, int stage, int x0, int y, int slot);
  void emit(const RpfSink& sink);
  [[nodiscard]] int halo(const Chain& chain, int stage) const;
  [[nodiscard]] Chain& frame() { return *chains_[adjacent_count_]; }
  [[nodiscard]] RpfReport report();

  const SampleSource& source_;
  const RpfParams& params_;
  RecordLayout layout_;
  int passes_;
  std::optional<LightReturn> light_;  // the stage after the passes
  int stages_;
  std::size_t adjacent_count_;
  std::shared_ptr<Memory> memory_;  // null: the heap
  std::vector<rpf::OffsetTable> tables_;
  exec::Runner runner_;
  std::vector<std::unique_ptr<PixelFilter>> filters_;  // per slot
  std::vector<std::unique_ptr<Chain>> chains_;         // adjacent frames, the frame itself, moved ones
  std::vector<const SampleRows*> moved_;
  std::unique_ptr<ErrorRows> errors_;
  std::array<Plane, 6> band_;
  int emitted_ = 0;
};

void check_sources(const SampleSource& source, const std::vector<SampleSource>& adjacent) {
  if (source.width < 1 || source.height < 1 || !source.next_row) {
    throw Error(ErrorCode::kInvalidArgument, "rpf: the source of samples is " + std::to_string(source.width) + "x" +
                                                 std::to_string(source.height) +
                                                 " pixels; it needs at least one, and a function for the next row");
  }
  const auto same = [](const SampleGroup& a, const SampleGroup& b) {
    return a.kind == b.kind && a.name == b.name && a.channels == b.channels;
  };
  for (std::size_t i = 0; i < adjacent.size(); ++i) {
    const SampleSource& other = adjacent[i];
    const bool is_alike =
        std::equal(source.groups.begin(), source.groups.end(), other.groups.begin(), other.groups.end(), same);
    if (other.width != source.width || other.height != source.height || !is_alike || !other.next_row) {
      throw Error(ErrorCode::kInvalidFrame,
                  "rpf: adjacent frame " + std::to_string(i) + " is " + std::to_string(other.width) + "x" +
                      std::to_string(other.height) + " pixels; it must have the size (" + std::to_string(source.width) +
                      "x" + std::to_string(source.height) + ") and the same channels as the frame itself");
    }
  }
}

RpfRun::RpfRun(const SampleSource& source, const RpfParams& params, const Execution& execution,
               const std::vector<SampleSource>& adjacent)
    : source_(source),
      params_(params),
      layout_(rpf::make_layout(source, params)),
      passes_(static_cast<int>(params.boxes.size())),
      stages_(passes_),
      adjacent_count_(adjacent.size()),
      memory_(execution.memory),
      runner_(execution) {
  for (const int box : params.boxes) tables_.emplace_back(box);
  if (params.return_sigma > 0) {
    light_.emplace(params.return_sigma);
    ++stages_;
  }
  for (int s = 0; s < runner_.slots(); ++s) {
    filters_.push_back(std::make_unique<PixelFilter>(layout_, params_, tables_));
  }
  for (const SampleSource& other : adjacent) add_chain(other);
  for (int draw = -1; draw < params.draws; ++draw) {
    add_chain(source);
    for (std::size_t a = 0; a < adjacent_count_; ++a) chains_.back()->adjacent.push_back(chains_[a].get());
    if (draw >= 0) moved_.push_back(&chains_.back()->rows);
  }
  int rows = kBandRows + 2;
  for (int s = 0; s < stages_; ++s) rows += halo(frame(), s);
  if (params.draws > 0) {
    rows += 2 * ErrorRows::kRadius;
    errors_ =
        std::make_unique<ErrorRows>(source.width, source.height, layout_, std::min(rows, source.height), memory_.get());
  }
  for (std::size_t k = 0; k < (errors_ ? 6U : 3U); ++k)
    band_[k] = Plane(source.width, std::min(rows, source.height), memory_.get());
}

// Rows of the stages before that a stage reads on each side.
int RpfRun::halo(const Chain& chain, int stage) const {
  if (stage == passes_) return light_->radius();
  return params_.boxes[static_cast<std::size_t>(stage)] / 2 + (chain.adjacent.empty() ? 0 : params_.search_radius);
}

// A window of rows for all stages: what the last of them reads lies that much behind what was read of the source.
void RpfRun::add_chain(const SampleSource& source) {
  int rows = 2 * kBandRows;
  for (const int box : params_.boxes) rows += 2 * (box / 2 + (adjacent_count_ > 0 ? params_.search_radius : 0));
  rows += light_ ? 2 * light_->radius() : 0;
  rows += params_.draws > 0 ? 2 * ErrorRows::kRadius : 0;
  const std::size_t balance = light_ ? light_->row_floats(source.width) : 0;
  SampleRows window(source, layout_, {passes_, balance}, std::min(rows, source.height), memory_.get());
  chains_.push_back(
      std::make_unique<Chain>(Chain{std::move(window), {}, std::vector<int>(static_cast<std::size_t>(stages_), 0)}));
}

void RpfRun::read_rows(int end) {
  for (std::size_t c = 0; c < chains_.size(); ++c) {
    SampleRows& rows = chains_[c]->rows;
    while (rows.rows_read() < end) {
      const int draw = static_cast<int>(c) - static_cast<int>(adjacent_count_) - 1;
      if (draw >= 0) {
        rows.move_row(frame().rows, {params_.seed, draw, params_.step});
      } else {
        rows.read_row();
      }
      rows.row(rows.rows_read() - 1)
          .shifts.assign(static_cast<std::size_t>(source_.width) * adjacent_count_, rpf::PixelShift{});
    }
  }
}

// A tile's part of a row.
void RpfRun::run_span(Chain& chain, const std::vector<const SampleRows*>& adjacent, int stage, int x0, int y,
                      int slot) {
  if (stage == passes_) {
    light_->run(stage, x0, y, chain.rows);
    return;
  }
  for (int x = x0; x < std::min(x0 + kTileWidth, source_.width); ++x) {
    filters_[static_cast<std::size_t>(slot)]->run(stage, x, y, chain.rows, adjacent);
    if (light_ && stage + 1 == passes_) light_->note_pixel(layout_, stage, x, chain.rows.row(y));
  }
}

void RpfRun::run_stage(Chain& chain, int stage, int end) {
  std::vector<const SampleRows*> adjacent;
  for (const Chain* other : chain.adjacent) adjacent.push_back(&other->rows);
  const int y0 = chain.done[static_cast<std::size_t>(stage)];
  const int across = (source_.width + kTileWidth - 1) / kTileWidth;
  const int down = (end - y0 + kTileHeight - 1) / kTileHeight;
  const double weight = static_cast<double>(end - y0) / source_.height / stages_ / static_cast<double>(chains_.size());
  runner_.for_each(across * down, weight, [&](int item, int slot) {
    const int x0 = item % across * kTileWidth;
    const int top = y0 + item / across * kTileHeight;
    for (int y = top; y < std::min(top + kTileHeight, end); ++y) {
      run_span(chain, adjacent, stage, x0, y, slot);
    }
  });
}

void RpfRun::advance(Chain& chain) {
  for (int s = 0; s < stages_; ++s) {
    const auto stage = static_cast<std::size_t>(s);
    int ready = s == 0 ? chain.rows.rows_read() : chain.done[stage - 1];
    for (const Chain* other : chain.adjacent) ready = std::min(ready, s == 0 ? ready : other->done[stage - 1]);
    if (ready < source_.height) ready = std::max(ready - halo(chain, s), chain.done[stage]);
    if (ready > chain.done[stage]) run_stage(chain, s, ready);
    chain.done[stage] = ready;
  }
}

void RpfRun::emit(const RpfSink& sink) {
  const int last = stages_ - 1;
  int ready = source_.height;
  for (std::size_t c = adjacent_count_; c < chains_.size(); ++c) ready = std::min(ready, chains_[c]->done.back());
  if (errors_) {
    while (errors_->rows_added() < ready) errors_->add_row(frame().rows, moved_, last, params_.step);
    if (ready < source_.height) ready = std::max(ready - ErrorRows::kRadius, emitted_);
  }
  if (ready == emitted_) return;
  RpfBand out{emitted_, {}, {}};
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = emitted_; y < ready; ++y) {
      const float* pixels = frame().rows.row(y).pixels[static_cast<std::size_t>(last)] + c;
      for (int x = 0; x < source_.width; ++x)
        band_[c].row(y - emitted_)[x] = pixels[static_cast<std::ptrdiff_t>(3) * x];
      if (errors_) errors_->smooth_row(static_cast<int>(c), y, band_[c + 3].row(y - emitted_));
    }
    const auto view = [&](const Plane& plane) {
      return ConstPlaneView(plane.row(0), source_.width, ready - emitted_, 0, plane.row_stride());
    };
    out.colour[c] = view(band_[c]);
    if (errors_) out.error[c] = view(band_[c + 3]);
  }
  sink(out);
  emitted_ = ready;
}

RpfReport RpfRun::report() {
  const rpf::SampleCounts& counts = frame().rows.counts();
  RpfReport report;
  report.samples = counts.samples;
  report.rejected = counts.rejected;
  report.repaired = counts.repaired;
  report.empty_pixels = counts.empty_pixels;
  report.single_pixels = counts.single_pixels;
  report.features = layout_.feature_names;
  report.randoms = layout_.random_names;
  if (errors_) report.mean_error = errors_->mean();
  const auto warn = [&](bool is_so, const char* what) {
    if (is_so) report.warnings.emplace_back(what);
  };
  warn(layout_.randoms == 0,
       "the samples have no random parameters: nothing can be told from noise but by the position");
  warn(layout_.features == 0, "the samples have no features: edges are known by the colour alone");
  warn(counts.samples < 4 * static_cast<std::int64_t>(source_.width) * source_.height,
       "there are fewer than 4 samples per pixel: the filter needs that many to tell what is alike");
  if (memory_) {
    report.scratch_bytes = memory_->usage().scratch_bytes;
    add_memory_warnings(memory_->usage(), report.warnings);
  }
  return report;
}

RpfReport RpfRun::run(const RpfSink& sink) {
  while (emitted_ < source_.height) {
    read_rows(std::min(frame().rows.rows_read() + kBandRows, source_.height));
    for (const auto& chain : chains_) advance(*chain);
    emit(sink);
  }
  return report();
}

}  // namespace

RpfReport filter_samples(const SampleSource& source, const RpfParams& params, const Execution& execution,
                         const RpfSink& sink, const std::vector<SampleSource>& adjacent) {
  params.check();
  check_sources(source, adjacent);
  return RpfRun(source, params, execution, adjacent).run(sink);
}

}  // namespace stein
