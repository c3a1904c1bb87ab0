// SPDX-License-Identifier: Apache-2.0
#include "exr/perturbation_attributes.hpp"

#include <ImfFloatAttribute.h>
#include <ImfIntAttribute.h>
#include <ImfStringAttribute.h>

#include <charconv>
#include <string>

#include "exr/source_file.hpp"
#include "stein/exr.hpp"

namespace stein::exr {
namespace {

constexpr const char* kSeed = "perturbationSeed";
constexpr const char* kDraw = "perturbationDraw";
constexpr const char* kStep = "perturbationStep";

bool parse(const std::string& text, std::uint64_t& seed) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, seed);
  return error == std::errc() && stop == end;
}

std::optional<Perturbation> perturbation_of(const Imf::Header& header, const std::string& path) {
  const auto* seed = header.findTypedAttribute<Imf::StringAttribute>(kSeed);
  const auto* draw = header.findTypedAttribute<Imf::IntAttribute>(kDraw);
  const auto* step = header.findTypedAttribute<Imf::FloatAttribute>(kStep);
  if (seed == nullptr && draw == nullptr && step == nullptr) return std::nullopt;
  Perturbation found;
  const std::string what = "'" + path + "': its attributes " + kSeed + ", " + kDraw + " and " + kStep;
  if (seed == nullptr || draw == nullptr || step == nullptr || !parse(seed->value(), found.seed)) {
    throw Error(ErrorCode::kInvalidFrame, what + " are not those of 'stein perturb'; remove them, or perturb again");
  }
  found.draw = draw->value();
  found.step = step->value();
  try {
    check(found);
  } catch (const Error& error) {
    throw Error(ErrorCode::kInvalidFrame, what + " cannot be: " + error.what());
  }
  return found;
}

}  // namespace

void insert_perturbation(const Perturbation& perturbation, Imf::Header& header) {
  header.insert(kSeed, Imf::StringAttribute(std::to_string(perturbation.seed)));
  header.insert(kDraw, Imf::IntAttribute(perturbation.draw));
  header.insert(kStep, Imf::FloatAttribute(perturbation.step));
}

std::optional<Perturbation> read_perturbation(const std::string& path) {
  return with_io_errors("read '" + path + "'", [&]() -> std::optional<Perturbation> {
    const SourceFile file(path);
    for (int part = 0; part < file.parts(); ++part) {
      if (auto found = perturbation_of(file.header(part), path)) return found;
    }
    return std::nullopt;
  });
}

}  // namespace stein::exr
