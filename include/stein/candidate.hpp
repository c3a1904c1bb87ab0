// SPDX-License-Identifier: Apache-2.0
//
// Images of other denoisers next to stein's own filters. Their error is estimated from how they answer to a small
// random step of their whole input (docs/candidates.md).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "stein/execution.hpp"
#include "stein/frame.hpp"
#include "stein/plane.hpp"

#pragma GCC visibility push(default)
namespace stein {

/// A random step of the whole input: pixel by pixel `step` times a direction of +-1 standard deviations that has the
/// joint covariance of its colour and features (all of the mean), and covariance 0 with any other pixel's.
struct Perturbation {
  std::uint64_t seed = 1;
  int draw = 0;        ///< [0..] of the seed: each is independent of the others
  float step = 0.05F;  ///< [1e-3..1] standard deviations of the noise
};

/// What an external denoiser is handed: colour and features of `frame` moved, everything else as it is. Unusable values
/// stay unusable, and a feature without covariances with the colour stays where it is.
class PerturbedFrame {
 public:
  /// Views `frame`, which must outlive this. @throws Error kInvalidFrame, kInvalidArgument, kCancelled.
  PerturbedFrame(const Frame& frame, const Perturbation& perturbation, const Execution& execution = {});

  [[nodiscard]] const Frame& frame() const noexcept { return moved_; }

 private:
  Frame moved_;
  std::vector<Plane> planes_;
};

/// @throws Error kInvalidArgument for a draw or step out of range.
void check(const Perturbation& perturbation);

inline constexpr float kExternalStep = 0.1F;  ///< measured with OIDN, docs/candidates.md

/// Another denoiser as a function. Called in the thread that called denoise(), with the frame as it is, unusable values
/// included, and once for each draw with a perturbed one; returns the colour in planes of the frame's size. Has to give
/// the same for the same. What it throws ends the call. One that clearly does not follow the perturbation is refused,
/// as one that draws random numbers, and one that never uses the pixel itself (docs/candidates.md).
struct ExternalDenoiser {
  std::function<std::array<Plane, 3>(const Frame& frame)> run;
  int draws = 1;               ///< [1..16] runs on perturbed frames
  float step = kExternalStep;  ///< as Perturbation::step
  std::uint64_t seed = 1;
};

/// What another denoiser made of the frame moved by `perturbation`; of another one it is refused.
struct ExternalDraw {
  Perturbation perturbation;
  std::array<ConstPlaneView, 3> image;
};

/// Its images, made before.
struct ExternalImages {
  std::array<ConstPlaneView, 3> image;  ///< of the frame as it is
  std::vector<ExternalDraw> draws;      ///< [1..16]
  /// All channels of all of the frame's layers, in their order, filtered with the weights of `image`, so that they
  /// still sum up to it; a frame with layers needs them. Of the frame as it is, and finite, as `image` then has to
  /// be.
  std::vector<ConstPlaneView> layers = {};
};

struct ExternalCandidate {
  std::string name;  ///< for report and messages
  std::variant<ExternalDenoiser, ExternalImages> source;
};

/// @throws Error kInvalidArgument naming the candidate.
void check(const ExternalCandidate& candidate);

}  // namespace stein
#pragma GCC visibility pop
