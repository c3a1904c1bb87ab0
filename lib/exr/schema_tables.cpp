// SPDX-License-Identifier: Apache-2.0
//
// What renderers call their channels. One table per habit; docs/inputs.md tells them in words.
#include <array>

#include "exr/schema.hpp"

namespace stein::exr {
namespace {

using enum Role;
using Names = std::string_view;

constexpr auto kMean = VarianceOf::kMean;
constexpr auto kSample = VarianceOf::kSample;
constexpr auto kSecondMoment = VarianceOf::kSecondMoment;
constexpr auto kNothing = VarianceOf::kAsStated;

template <std::size_t N, std::size_t M>
constexpr std::array<SchemaEntry, N + M> join(const std::array<SchemaEntry, N>& a,
                                              const std::array<SchemaEntry, M>& b) {
  std::array<SchemaEntry, N + M> all{};
  for (std::size_t i = 0; i < N; ++i) all[i] = a[i];
  for (std::size_t i = 0; i < M; ++i) all[N + i] = b[i];
  return all;
}

constexpr std::array kFeatures = {
    KnownFeature{"albedo", "textures guide nothing"},
    KnownFeature{"normal", "creases of the geometry guide nothing"},
    KnownFeature{"depth", "edges between near and far guide nothing"},
    KnownFeature{"position", "places in the scene guide nothing"},
    KnownFeature{"visibility", "edges of shadows guide nothing"},
};

constexpr std::array<Names, 11> kMainParts = {"",       "rgba", "RGBA", "rgb",      "RGB",  "beauty",
                                              "Beauty", "C",    "main", "Combined", "color"};

// Where the variances are of the mean, the number of samples changes next to nothing.
constexpr float kAssumedSamples = 16;

constexpr std::array<Names, 2> kNativeSignature = {"R", "variance.R"};
constexpr std::array kNativeEntries = {
    SchemaEntry{"<C>", kColour},
    SchemaEntry{"A", kAlpha},
    SchemaEntry{"sampleCount", kSampleCount},
    SchemaEntry{"variance.<C>", kColourVariance, kMean},
    SchemaEntry{"covariance.<C>.<C>", kColourCovariance, kMean},
    SchemaEntry{"covariance.<C>.<feature>.<c>", kFeatureCovariance, kMean},
    SchemaEntry{"error.<c>", kEarlierResult},
    SchemaEntry{"choice.<c>", kEarlierResult},
    SchemaEntry{"density.<c>", kEarlierResult},
    SchemaEntry{"noisy.<C>", kNoisyColour},
    SchemaEntry{"<feature>.variance.<c>", kFeatureVariance, kMean},
    SchemaEntry{"<feature>.<c>", kFeatureMean},
};

// What earlier runs of stein left in files of others; further layers.
constexpr std::array kEarlierAndFurther = {
    SchemaEntry{"error.<c>", kEarlierResult},   SchemaEntry{"choice.<c>", kEarlierResult},
    SchemaEntry{"density.<c>", kEarlierResult}, SchemaEntry{"noisy.<C>", kNoisyColour},
    SchemaEntry{"<feature>.<c>", kFeatureMean},
};

constexpr std::array<Names, 3> kPbrtSignature = {"R", "Variance.R", "Albedo.R"};
constexpr std::array kPbrtEntries = join(
    std::array{
        SchemaEntry{"<C>", kColour},
        SchemaEntry{"Variance.<C>", kColourVariance, kSample},
        SchemaEntry{"RelativeVariance.<C>", kNoise},
        SchemaEntry{"Albedo.<C>", kFeatureMean, kNothing, "albedo"},
        SchemaEntry{"Ns.<X>", kFeatureMean, kNothing, "normal"},
        SchemaEntry{"Ns<c>", kFeatureMean, kNothing, "normal"},
        SchemaEntry{"P.<X>", kFeatureMean, kNothing, "position"},
        SchemaEntry{"Px", kFeatureMean, kNothing, "position", "X"},
        SchemaEntry{"Py", kFeatureMean, kNothing, "position", "Y"},
        SchemaEntry{"Pz", kFeatureMean, kNothing, "position", "Z"},
    },
    kEarlierAndFurther);
constexpr std::array<Names, 3> kPbrtAssumptions = {
    "Variance.R/G/B are those of X, Y, Z, as pbrt's default sensor has it; in R, G, B they are taken as if X, Y and Z "
    "varied together, which is up to 1.5 times too much",
    "a variance of 0 is unknown, because pbrt counts only samples that hit a surface; there it is the squared "
    "median difference from such pixels of the 3x3 around",
    "at silhouettes and the edges of lamps pbrt's variances are too small, so noise may stay there",
};

// The names of AOVs are the user's; their types show in the components.
constexpr std::array kMitsubaFeatures = join(
    std::array{
        SchemaEntry{"<layer>.*.T", kFeatureMean, kNothing, "depth", "T"},
        SchemaEntry{"m2_<layer>.*.T", kFeatureVariance, kSecondMoment, "depth", "T"},
        SchemaEntry{"<layer>.n*.<X>", kFeatureMean, kNothing, "normal"},
        SchemaEntry{"m2_<layer>.n*.<X>", kFeatureVariance, kSecondMoment, "normal"},
        SchemaEntry{"<layer>.sh*.<X>", kFeatureMean, kNothing, "normal"},
        SchemaEntry{"m2_<layer>.sh*.<X>", kFeatureVariance, kSecondMoment, "normal"},
        SchemaEntry{"<layer>.p*.<X>", kFeatureMean, kNothing, "position"},
        SchemaEntry{"m2_<layer>.p*.<X>", kFeatureVariance, kSecondMoment, "position"},
        SchemaEntry{"<layer>.*.<C>", kFeatureMean, kNothing, "albedo"},
        SchemaEntry{"m2_<layer>.*.<C>", kFeatureVariance, kSecondMoment, "albedo"},
        SchemaEntry{"m2_<feature>.<c>", kNoise},
    },
    kEarlierAndFurther);
constexpr std::array kMitsubaColour = {
    SchemaEntry{"<C>", kColour},
    SchemaEntry{"A", kAlpha},
};

constexpr std::array<Names, 3> kMitsubaSignature = {"R", "m2_<layer>.<image>.A", "m2_<layer>.<image>.R"};
constexpr std::array kMitsubaEntries =
    join(join(kMitsubaColour,
              std::array{
                  SchemaEntry{"m2_<layer>.<image>.<C>", kColourVariance, kSecondMoment},
                  SchemaEntry{"m2_<layer>.<image>.<c>", kNoise},
                  SchemaEntry{"<layer>.<image>.<c>", kNone},
                  SchemaEntry{"m2_<layer>.<X>", kNoise},
                  SchemaEntry{"<layer>.<X>", kNone},
              }),
         kMitsubaFeatures);

constexpr std::array<Names, 2> kMitsubaXyzSignature = {"R", "m2_<layer>.X"};
constexpr std::array kMitsubaXyzEntries = join(join(kMitsubaColour,
                                                    std::array{
                                                        SchemaEntry{"m2_<layer>.<X>", kColourVariance, kSecondMoment},
                                                        SchemaEntry{"<layer>.<X>", kNone},
                                                    }),
                                               kMitsubaFeatures);
constexpr std::array<Names, 1> kMitsubaXyzAssumptions = {
    "the second moments are of X, Y, Z; in R, G, B variances are taken as if X, Y and Z varied together, which is "
    "somewhat too much",
};

constexpr std::array<Names, 2> kMitsubaAovSignature = {"R", "*.T"};
constexpr std::array kMitsubaAovEntries = join(join(kMitsubaColour,
                                                    std::array{
                                                        SchemaEntry{"*.T", kFeatureMean, kNothing, "depth", "T"},
                                                        SchemaEntry{"n*.<X>", kFeatureMean, kNothing, "normal"},
                                                        SchemaEntry{"sh*.<X>", kFeatureMean, kNothing, "normal"},
                                                        SchemaEntry{"p*.<X>", kFeatureMean, kNothing, "position"},
                                                        SchemaEntry{"a*.<C>", kFeatureMean, kNothing, "albedo"},
                                                    }),
                                               kEarlierAndFurther);

constexpr std::array kCyclesFeatures = join(
    std::array{
        SchemaEntry{"<layer>.Denoising Albedo.<c>", kFeatureMean, kNothing, "albedo"},
        SchemaEntry{"<layer>.Denoising Albedo Variance.<c>", kFeatureVariance, kMean, "albedo"},
        SchemaEntry{"<layer>.Denoising Normal.<c>", kFeatureMean, kNothing, "normal"},
        SchemaEntry{"<layer>.Denoising Normal Variance.<c>", kFeatureVariance, kMean, "normal"},
        SchemaEntry{"<layer>.Denoising Depth.<c>", kFeatureMean, kNothing, "depth"},
        SchemaEntry{"<layer>.Denoising Depth Variance.<c>", kFeatureVariance, kMean, "depth"},
        SchemaEntry{"<layer>.Denoising Shadowing.<c>", kFeatureMean, kNothing, "visibility"},
        SchemaEntry{"<layer>.Denoising Image Variance.<C>", kColourVariance, kMean},
        SchemaEntry{"<layer>.Denoising Variance.<C>", kColourVariance, kMean},
        SchemaEntry{"<layer>.Position.<X>", kFeatureMean, kNothing, "position"},
    },
    kEarlierAndFurther);
constexpr std::array<Names, 1> kCyclesSignature = {"<layer>.Combined.R"};
constexpr std::array kCyclesEntries = join(
    std::array{
        SchemaEntry{"<layer>.Combined.<C>", kColour},
        SchemaEntry{"<layer>.Combined.A", kAlpha},
    },
    kCyclesFeatures);
// A file that Cycles has denoised keeps its noisy image.
constexpr std::array<Names, 1> kCyclesNoisySignature = {"<layer>.Noisy Image.R"};
constexpr std::array kCyclesNoisyEntries = join(
    std::array{
        SchemaEntry{"<layer>.Noisy Image.<C>", kColour},
        SchemaEntry{"<layer>.Noisy Image.A", kAlpha},
    },
    kCyclesFeatures);
constexpr std::array<Names, 1> kCyclesAssumptions = {
    "every pixel has as many samples as the render layer: no adaptive sampling",
};
constexpr std::array<Names, 2> kCyclesVarianceSignature = {
    "<layer>.Noisy Image.R", "<layer>.Denoising Variance.R|<layer>.Denoising Image Variance.R"};
constexpr std::array<Names, 2> kCyclesVarianceAssumptions = {
    kCyclesAssumptions[0],
    "the variances of Cycles before 3.0 are of the mean (--variance-of sample, if they are not)",
};

constexpr std::array<Names, 3> kArnoldSignature = {
    "R", "variance.R",
    "denoise_albedo.R|denoise_albedo_noisy.R|diffuse_albedo.R|diffuse_albedo_noice.R|N_noice.X|N_noice.R|Z_noice"};
constexpr std::array kArnoldEntries = join(
    std::array{
        SchemaEntry{"<C>", kColour},
        SchemaEntry{"A", kAlpha},
        SchemaEntry{"variance.<C>", kColourVariance, kMean},
        SchemaEntry{"denoise_albedo.<C>", kFeatureMean, kNothing, "albedo"},
        SchemaEntry{"denoise_albedo_noisy.<C>", kFeatureMean, kNothing, "albedo"},
        SchemaEntry{"diffuse_albedo_noice.<C>", kFeatureMean, kNothing, "albedo"},
        SchemaEntry{"diffuse_albedo.<C>", kFeatureMean, kNothing, "albedo"},
        SchemaEntry{"N_noice.<c>", kFeatureMean, kNothing, "normal"},
        SchemaEntry{"N.<c>", kFeatureMean, kNothing, "normal"},
        SchemaEntry{"Z_noice", kFeatureMean, kNothing, "depth", "Z"},
        SchemaEntry{"Z_noice.<c>", kFeatureMean, kNothing, "depth", "Z"},
        SchemaEntry{"Z", kFeatureMean, kNothing, "depth", "Z"},
    },
    kEarlierAndFurther);
constexpr std::array<Names, 1> kArnoldAssumptions = {
    "the layer variance is that of the mean (--variance-of sample, if it is not)",
};

constexpr std::array<Names, 2> kRendermanSignature = {"mse.<rgb>", "Ci.<rgb>|<rgb>"};
constexpr std::array kRendermanEntries = join(
    std::array{
        SchemaEntry{"Ci.<rgb>", kColour},
        SchemaEntry{"<rgb>", kColour},
        SchemaEntry{"a", kAlpha},
        SchemaEntry{"A", kAlpha},
        SchemaEntry{"sampleCount", kSampleCount},
        SchemaEntry{"sampleCount.<c>", kSampleCount},
        SchemaEntry{"mse.<rgb>", kColourVariance, kMean},
        SchemaEntry{"albedo_mse.<c>", kFeatureVariance, kMean, "albedo"},
        SchemaEntry{"albedo_var.<c>", kFeatureVariance, kSample, "albedo"},
        SchemaEntry{"normal_mse.<c>", kFeatureVariance, kMean, "normal"},
        SchemaEntry{"normal_var.<c>", kFeatureVariance, kSample, "normal"},
        SchemaEntry{"zfiltered", kFeatureMean, kNothing, "depth", "Z"},
        SchemaEntry{"zfiltered_var", kFeatureVariance, kSample, "depth", "Z"},
        SchemaEntry{"z", kFeatureMean, kNothing, "depth", "Z"},
        SchemaEntry{"z_var", kFeatureVariance, kSample, "depth", "Z"},
        SchemaEntry{"diffuse_mse.<c>", kNoise},
        SchemaEntry{"specular_mse.<c>", kNoise},
    },
    kEarlierAndFurther);
constexpr std::array<Names, 1> kRendermanAssumptions = {
    "layers *mse are variances of the mean, layers *_var those of single samples (--variance-of mean, if they are not)",
};

constexpr std::array<Names, 2> kTungstenSignature = {"R", "colorVariance.R"};
constexpr std::array kTungstenEntries = join(
    std::array{
        SchemaEntry{"<C>", kColour},
        SchemaEntry{"A", kAlpha},
        SchemaEntry{"colorVariance.<C>", kColourVariance, kMean},
        SchemaEntry{"albedo.<C>", kFeatureMean, kNothing, "albedo"},
        SchemaEntry{"albedoVariance.<C>", kFeatureVariance, kMean, "albedo"},
        SchemaEntry{"normal.<C>", kFeatureMean, kNothing, "normal"},
        SchemaEntry{"normalVariance.<C>", kFeatureVariance, kMean, "normal"},
        SchemaEntry{"depth.<c>", kFeatureMean, kNothing, "depth"},
        SchemaEntry{"depthVariance.<c>", kFeatureVariance, kMean, "depth"},
        SchemaEntry{"visibility.<c>", kFeatureMean, kNothing, "visibility"},
        SchemaEntry{"visibilityVariance.<c>", kFeatureVariance, kMean, "visibility"},
    },
    kEarlierAndFurther);
constexpr std::array<Names, 10> kTungstenFiles = {"color",      "colorVariance",     "albedo", "albedoVariance",
                                                  "normal",     "normalVariance",    "depth",  "depthVariance",
                                                  "visibility", "visibilityVariance"};

constexpr std::string_view kMergeSeeds =
    "merge two or more renders with different seeds (stein merge), which gives variances";

}  // namespace

std::span<const Schema> schemas() {
  static constexpr std::array kSchemas = {
      Schema{.name = "arnold",
             .renderer = "Arnold, as for noice",
             .signature = kArnoldSignature,
             .entries = kArnoldEntries,
             .features = kFeatures,
             .main_parts = kMainParts,
             .assumed_samples = kAssumedSamples,
             .assumptions = kArnoldAssumptions},
      Schema{.name = "native",
             .renderer = "stein's own names",
             .signature = kNativeSignature,
             .entries = kNativeEntries,
             .features = kFeatures,
             .main_parts = kMainParts},
      Schema{.name = "pbrt",
             .renderer = "pbrt-v4, GBufferFilm",
             .signature = kPbrtSignature,
             .entries = kPbrtEntries,
             .features = kFeatures,
             .main_parts = kMainParts,
             .variance_space = VarianceSpace::kXyz,
             .zero_variance_is_unknown = true,
             .assumptions = kPbrtAssumptions},
      Schema{.name = "mitsuba",
             .renderer = "Mitsuba 3, moment over aov",
             .signature = kMitsubaSignature,
             .entries = kMitsubaEntries,
             .features = kFeatures,
             .main_parts = kMainParts},
      Schema{.name = "mitsuba",
             .renderer = "Mitsuba 3, moment",
             .signature = kMitsubaXyzSignature,
             .entries = kMitsubaXyzEntries,
             .features = kFeatures,
             .main_parts = kMainParts,
             .variance_space = VarianceSpace::kXyz,
             .assumptions = kMitsubaXyzAssumptions},
      Schema{.name = "mitsuba",
             .renderer = "Mitsuba 3, aov",
             .signature = kMitsubaAovSignature,
             .entries = kMitsubaAovEntries,
             .features = kFeatures,
             .main_parts = kMainParts,
             .assumed_samples = kAssumedSamples,
             .without_variance = "put a moment integrator around the aov integrator, or render with several seeds and "
                                 "merge them (stein merge)"},
      Schema{.name = "cycles",
             .renderer = "Cycles before 3.0, with variances",
             .signature = kCyclesVarianceSignature,
             .entries = kCyclesNoisyEntries,
             .features = kFeatures,
             .main_parts = kMainParts,
             .samples_attribute = "cycles.<layer>.samples",
             .assumed_samples = kAssumedSamples,
             .assumptions = kCyclesVarianceAssumptions,
             .without_variance = kMergeSeeds},
      Schema{.name = "cycles",
             .renderer = "Cycles, noisy image",
             .signature = kCyclesNoisySignature,
             .entries = kCyclesNoisyEntries,
             .features = kFeatures,
             .main_parts = kMainParts,
             .samples_attribute = "cycles.<layer>.samples",
             .assumed_samples = kAssumedSamples,
             .assumptions = kCyclesAssumptions,
             .without_variance = kMergeSeeds},
      Schema{.name = "cycles",
             .renderer = "Cycles, multilayer",
             .signature = kCyclesSignature,
             .entries = kCyclesEntries,
             .features = kFeatures,
             .main_parts = kMainParts,
             .samples_attribute = "cycles.<layer>.samples",
             .assumed_samples = kAssumedSamples,
             .assumptions = kCyclesAssumptions,
             .without_variance = kMergeSeeds},
      Schema{.name = "renderman",
             .renderer = "RenderMan, variance file",
             .signature = kRendermanSignature,
             .entries = kRendermanEntries,
             .features = kFeatures,
             .main_parts = kMainParts,
             .assumed_samples = kAssumedSamples,
             .assumptions = kRendermanAssumptions},
      Schema{.name = "tungsten",
             .renderer = "Tungsten, one file per buffer",
             .signature = kTungstenSignature,
             .entries = kTungstenEntries,
             .features = kFeatures,
             .main_parts = kMainParts,
             .assumed_samples = kAssumedSamples,
             .companions = kTungstenFiles},
  };
  return kSchemas;
}

const Schema& native_schema() { return schemas()[1]; }

}  // namespace stein::exr
