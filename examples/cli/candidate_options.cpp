// SPDX-License-Identifier: Apache-2.0
#include "candidate_options.hpp"

#include <CLI/Option.hpp>
#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <sstream>

#include "stein/error.hpp"

namespace stein::cli {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::kInvalidArgument, message); }

struct NamedPath {
  std::string name;  // as given, or the file's up to its first dot
  std::string path;
};

// A '=' in the name of a folder or file is none that divides, unless it comes first.
std::size_t place_of_path(const std::string& text) {
  const std::size_t equals = text.find('=');
  return equals == std::string::npos || text.find('/') < equals ? 0 : equals + 1;
}

NamedPath named_path(const std::string& text) {
  const std::size_t at = place_of_path(text);
  const std::string path = text.substr(at);
  const std::string file = std::filesystem::path(path).filename().string();
  return {at > 0 ? text.substr(0, at - 1) : file.substr(0, file.find('.')), path};
}

std::vector<std::string> split_paths(const std::string& text) {
  std::vector<std::string> paths;
  std::istringstream in(text);
  for (std::string path; std::getline(in, path, ',');) paths.push_back(path);
  return paths;
}

std::string joined(const std::vector<std::string>& paths) {
  std::string text;
  for (const std::string& path : paths) text += (text.empty() ? "" : ",") + path;
  return text;
}

std::string text_of(float value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

class Reader {
 public:
  Reader(const CandidateOptions& options, Memory* memory, const std::function<void()>& check_going_on)
      : options_(options), memory_(memory), check_going_on_(check_going_on) {}

  LoadedCandidates read() {
    check(options_);
    for (std::size_t i = 0; i < options_.images.size(); ++i) {
      const NamedPath image = named_path(options_.images[i]);
      if (exr::read_perturbation(image.path)) {
        refuse("--candidate '" + image.path +
               "' was made of a perturbed file; it is one of --candidate-perturbed, and --candidate is of IN itself");
      }
      ExternalImages images{load(image.path), {}};
      for (const std::string& path : split_paths(options_.perturbed[i])) add_draw(path, images);
      loaded_.list.push_back({image.name, std::move(images)});
    }
    return std::move(loaded_);
  }

 private:
  std::array<ConstPlaneView, 3> load(const std::string& path) {
    check_going_on_();
    loaded_.planes.push_back(exr::read_planes(path, {}, memory_));
    const std::vector<Plane>& planes = loaded_.planes.back().planes;
    return {planes[0].view(), planes[1].view(), planes[2].view()};
  }

  void add_draw(const std::string& path, ExternalImages& images) {
    const Perturbation perturbation = perturbation_of(path, static_cast<int>(images.draws.size()));
    for (const ExternalDraw& other : images.draws) {
      if (other.perturbation.seed != perturbation.seed || other.perturbation.draw != perturbation.draw) continue;
      refuse("--candidate-perturbed '" + path + "' is of the same draw as one before it, draw " +
             std::to_string(perturbation.draw) + " of the seed " + std::to_string(perturbation.seed) +
             "; perturb with another --draw");
    }
    images.draws.push_back({perturbation, load(path)});
  }

  // As the file says; where it does not, as the options say.
  [[nodiscard]] Perturbation perturbation_of(const std::string& path, int draw) const {
    if (const auto stated = exr::read_perturbation(path)) {
      if (options_.seed && *options_.seed != stated->seed) {
        refuse("--candidate-seed " + std::to_string(*options_.seed) + ": '" + path + "' says that its seed was " +
               std::to_string(stated->seed) + "; leave the option out");
      }
      if (options_.step && *options_.step != stated->step) {
        refuse("--candidate-step " + text_of(*options_.step) + ": '" + path + "' says that its step was " +
               text_of(stated->step) + "; leave the option out");
      }
      return *stated;
    }
    return {options_.seed.value_or(Perturbation{}.seed), draw, options_.step.value_or(kExternalStep)};
  }

  const CandidateOptions& options_;
  Memory* memory_;
  const std::function<void()>& check_going_on_;
  LoadedCandidates loaded_;
};

}  // namespace

void CandidateOptions::for_each_path(const std::function<void(std::string& path)>& change) {
  for (std::string& text : images) {
    const std::size_t at = place_of_path(text);
    std::string path = text.substr(at);
    change(path);
    text = text.substr(0, at) + path;
  }
  for (std::string& text : perturbed) {
    std::vector<std::string> paths = split_paths(text);
    std::for_each(paths.begin(), paths.end(), change);
    text = joined(paths);
  }
}

void declare(CLI::App& verb, CandidateOptions& options) {
  verb.add_option("--candidate", options.images,
                  "[NAME=]FILE: what another denoiser made of IN, to be mixed with what the filters make of it; may be "
                  "repeated")
      ->allow_extra_args(false);
  verb.add_option("--candidate-perturbed", options.perturbed,
                  "FILE[,FILE...]: what it made of the files of 'stein perturb', in the order of their draws from 0; "
                  "the first for the first --candidate, and so on")
      ->allow_extra_args(false);
  verb.add_option("--candidate-seed", options.seed, "As given to 'stein perturb', where the files do not say; 1");
  verb.add_option("--candidate-step", options.step,
                  "As given to 'stein perturb', where the files do not say; " + text_of(kExternalStep));
}

void check(const CandidateOptions& options) {
  if (options.perturbed.size() > options.images.size()) {
    refuse("--candidate-perturbed '" + options.perturbed[options.images.size()] +
           "' has no --candidate that it belongs to; give one --candidate for each");
  }
  for (std::size_t i = 0; i < options.images.size(); ++i) {
    const NamedPath image = named_path(options.images[i]);
    if (i >= options.perturbed.size() || split_paths(options.perturbed[i]).empty()) {
      refuse("--candidate '" + image.path +
             "' has no --candidate-perturbed, without which its error is not known; denoise what 'stein perturb' makes "
             "of IN with it as well");
    }
  }
  if (options.images.empty() && (options.seed || options.step)) {
    refuse(std::string(options.seed ? "--candidate-seed" : "--candidate-step") + " without --candidate");
  }
}

LoadedCandidates read_candidates(const CandidateOptions& options, Memory* memory,
                                 const std::function<void()>& check_going_on) {
  return Reader(options, memory, check_going_on).read();
}

}  // namespace stein::cli
