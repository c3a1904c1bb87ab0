// SPDX-License-Identifier: Apache-2.0
//
// RPF: Sen, Darabi, "On Filtering the Noise from the Random Parameters in Monte Carlo Rendering", 2012.
#include "stein/rpf.hpp"

#include <algorithm>
#include <memory>
#include <numeric>

#include "core/parameter_check.hpp"
#include "exec/row_pipeline.hpp"
#include "exec/runner.hpp"
#include "rpf/pixel_filter.hpp"
#include "stein/error.hpp"

namespace stein {
namespace {

using rpf::PixelFilter;
using rpf::SampleRows;

constexpr int kBand = 16;
constexpr int kTile = 16;

}  // namespace

void RpfParams::check() const {}

RpfReport filter_samples(const SampleSource& source, const RpfParams& params, const Execution& execution,
                         const RpfSink& sink) {
  params.check();
  const rpf::RecordLayout layout = rpf::make_layout(source, params);
  const int passes = static_cast<int>(params.boxes.size());
  std::vector<rpf::OffsetTable> tables;
  int halos = 0;
  for (const int box : params.boxes) {
    tables.emplace_back(box);
    halos += box / 2;
  }
  SampleRows rows(source, layout, passes, std::min(source.height, kBand + 2 * halos + 1));
  exec::Runner runner(execution);
  std::vector<std::unique_ptr<PixelFilter>> filters;
  for (int s = 0; s < runner.slots(); ++s) filters.push_back(std::make_unique<PixelFilter>(layout, params, tables));
  const std::vector<rpf::NeighbourFrame> frames = {{&rows, 0, 0}};
  std::vector<int> done(static_cast<std::size_t>(passes), 0);
  std::array<Plane, 3> band;
  for (Plane& p : band) p = Plane(source.width, kBand + halos + 1 < source.height ? kBand + halos + 1 : source.height);
  while (done.back() < source.height) {
    int ready = std::min(rows.rows_read() + kBand, source.height);
    while (rows.rows_read() < ready) rows.read_row();
    for (int p = 0; p < passes; ++p) {
      const auto s = static_cast<std::size_t>(p);
      if (ready < source.height) ready = std::max(ready - params.boxes[s] / 2, done[s]);
      const int y0 = done[s];
      const int across = (source.width + kTile - 1) / kTile;
      const int down = (ready - y0 + kTile - 1) / kTile;
      const double weight = static_cast<double>(ready - y0) / source.height / passes;
      runner.for_each(across * down, weight, [&](int item, int slot) {
        const int tx = item % across * kTile;
        const int ty = y0 + item / across * kTile;
        for (int y = ty; y < std::min(ty + kTile, ready); ++y) {
          for (int x = tx; x < std::min(tx + kTile, source.width); ++x) {
            filters[static_cast<std::size_t>(slot)]->run(p, x, y, frames, rows);
          }
        }
      });
      if (p + 1 == passes && ready > y0) {
        for (int y = y0; y < ready; ++y) {
          const float* pixels = rows.row(y).pixels[s].data();
          for (std::size_t c = 0; c < 3; ++c) {
            for (int x = 0; x < source.width; ++x) band[c].row(y - y0)[x] = pixels[3 * x + static_cast<int>(c)];
          }
        }
        RpfBand out{y0, {}};
        for (std::size_t c = 0; c < 3; ++c) out.colour[c] = ConstPlaneView(band[c].row(0), source.width, ready - y0, 0, band[c].row_stride());
        sink(out);
      }
      done[s] = ready;
    }
  }
  RpfReport report;
  report.samples = rows.counts().samples;
  report.rejected = rows.counts().rejected;
  report.repaired = rows.counts().repaired;
  report.empty_pixels = rows.counts().empty_pixels;
  report.features = layout.feature_names;
  report.randoms = layout.random_names;
  return report;
}

}  // namespace stein
