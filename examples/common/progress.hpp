// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

namespace stein::cli {

enum class ProgressStyle {
  kNone,
  kLines,  ///< "NN%" or "NN% M:SS left" lines, about every 10 %: for logs and farms
  kBar,    ///< one line that is redrawn: for terminals
};

/// kNone if `quiet`, else by whether stderr is a terminal.
[[nodiscard]] ProgressStyle choose_progress_style(bool quiet);

/// " M:SS left" or " H:MM:SS left" at the pace so far; empty as long as there is too little to go by.
[[nodiscard]] std::string time_left(double seconds_so_far, double fraction);

/// Shows the fraction done and the time left on stderr. Not thread-safe: calls must not overlap.
class Progress {
 public:
  explicit Progress(ProgressStyle style) : style_(style) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { clear(); }

  void show(double fraction);
  void clear();  ///< removes the bar, so that a message can follow; the next `show` brings it back

 private:
  ProgressStyle style_;
  int shown_percent_ = -1;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Of something larger, the part that is at hand.
class ProgressPart {
 public:
  ProgressPart(Progress& whole, double begin, double share) : whole_(whole), begin_(begin), share_(share) {}

  void show(double fraction) const { whole_.show(begin_ + share_ * fraction); }
  void clear() const { whole_.clear(); }

 private:
  Progress& whole_;
  double begin_;
  double share_;
};

}  // namespace stein::cli
