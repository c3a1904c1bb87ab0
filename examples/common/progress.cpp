// SPDX-License-Identifier: Apache-2.0
#include "progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
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

std::string time_left(double seconds_so_far, double fraction) {
  constexpr double kLeastSeconds = 3;
  constexpr double kLeastFraction = 0.01;
  if (seconds_so_far < kLeastSeconds || fraction < kLeastFraction || fraction >= 1) {
    return {};
  }
  const auto seconds = static_cast<long>(std::lround(seconds_so_far * (1 - fraction) / fraction));
  const auto two_digits = [](long number) { return (number < 10 ? "0" : "") + std::to_string(number); };
  const long hours = seconds / 3600;
  const long minutes = seconds / 60 % 60;
  const std::string start = hours > 0 ? std::to_string(hours) + ":" + two_digits(minutes) : std::to_string(minutes);
  return " " + start + ":" + two_digits(seconds % 60) + " left";
}

void Progress::clear() {
  if (style_ == ProgressStyle::kBar && shown_percent_ >= 0) {
    std::fputs("\r\033[K", stderr);
    shown_percent_ = -1;
  }
}

void Progress::show(double fraction) {
  constexpr int kLineStep = 10;
  constexpr int kBarWidth = 40;
  const int percent = static_cast<int>(100 * std::clamp(fraction, 0.0, 1.0));
  if (percent <= shown_percent_ || style_ == ProgressStyle::kNone) {
    return;
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  const std::string left = time_left(elapsed.count(), fraction);
  if (style_ == ProgressStyle::kBar) {
    const std::string done(static_cast<std::size_t>(percent * kBarWidth / 100), '#');
    std::fprintf(stderr, "\r[%-*s] %3d%%%s\033[K", kBarWidth, done.c_str(), percent, left.c_str());
  } else if (shown_percent_ < 0 || percent / kLineStep > shown_percent_ / kLineStep) {
    std::fprintf(stderr, "%d%%%s\n", percent, left.c_str());
  }
  shown_percent_ = percent;
}

}  // namespace stein::cli
