// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stein::cli {

enum class ProgressStyle {
  kNone,
  kLines,  ///< "NN%" lines, about every 10 %: for logs and farms
  kBar,    ///< one line that is redrawn: for terminals
};

/// kNone if `quiet`, else by whether stderr is a terminal.
[[nodiscard]] ProgressStyle choose_progress_style(bool quiet);

/// Shows the fraction done on stderr. Not thread-safe: calls must not overlap.
class Progress {
 public:
  explicit Progress(ProgressStyle style) : style_(style) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();  ///< removes the bar, so that a message can follow

  void show(double fraction);

 private:
  ProgressStyle style_;
  int shown_percent_ = -1;
};

}  // namespace stein::cli
