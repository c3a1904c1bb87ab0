// SPDX-License-Identifier: Apache-2.0
#include "progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <string>

namespace stein::cli {

ProgressStyle choose_progress_style(bool quiet) {
  if (quiet) {
    return ProgressStyle::kNone;
  }
  return isatty(STDERR_FILENO) != 0 ? ProgressStyle::kBar : ProgressStyle::kLines;
}

Progress::~Progress() {
  if (style_ == ProgressStyle::kBar && shown_percent_ >= 0) {
    std::fputs("\r\033[K", stderr);
  }
}

void Progress::show(double fraction) {
  constexpr int kLineStep = 10;
  constexpr int kBarWidth = 40;
  const int percent = static_cast<int>(100 * std::clamp(fraction, 0.0, 1.0));
  if (percent <= shown_percent_ || style_ == ProgressStyle::kNone) {
    return;
  }
  if (style_ == ProgressStyle::kBar) {
    const std::string done(static_cast<std::size_t>(percent * kBarWidth / 100), '#');
    std::fprintf(stderr, "\r[%-*s] %3d%%", kBarWidth, done.c_str(), percent);
  } else if (shown_percent_ < 0 || percent / kLineStep > shown_percent_ / kLineStep) {
    std::fprintf(stderr, "%d%%\n", percent);
  }
  shown_percent_ = percent;
}

}  // namespace stein::cli
