/* SPDX-License-Identifier: Apache-2.0
 *
 * stein for C (C99) and for any language that calls C. docs/integrate.md has a program to start from; what the planes
 * mean, and what makes a result wrong, is in docs/inputs.md.
 *
 *   stein_frame*   what the renderer knows: views of its own memory, by name; or a snapshot of a film
 *   stein_params*  a filter and its options
 *   stein_result*  what came out
 *   stein_film*    accumulates samples, for a renderer that keeps no variances
 *
 * Common to all functions:
 * - Those that can fail return a status, STEIN_OK or what went wrong; stein_error_message() then says what, and what to
 *   do about it. A call that fails changes nothing, and sets what it would have made to null. No C++ exception leaves.
 * - Handles belong to the caller, who ends each with its _destroy, which takes null as well.
 * - There is no global state. Any number of threads may call at the same time, on the same handle too, as long as none
 *   of them changes it. Functions that change a handle take it without const.
 * - Strings are UTF-8, end with a zero, and are copied. y points down. Strides are in bytes and may be negative.
 */
#ifndef STEIN_H
#define STEIN_H

#include <stddef.h>
#include <stdint.h>

/* Of this header; stein_version() is that of the library. Both are 10000 * major + 100 * minor + patch. */
#define STEIN_VERSION_MAJOR 0
#define STEIN_VERSION_MINOR 1
#define STEIN_VERSION_PATCH 0
#define STEIN_VERSION (10000 * STEIN_VERSION_MAJOR + 100 * STEIN_VERSION_MINOR + STEIN_VERSION_PATCH)

#ifdef __GNUC__
#define STEIN_API __attribute__((visibility("default")))
#else
#define STEIN_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef int32_t stein_status;
enum {
  STEIN_OK = 0,
  STEIN_INVALID_ARGUMENT = 1, /* an argument or option: null, unknown, or out of its range */
  STEIN_INVALID_FRAME = 2,    /* planes are missing, or hold values that cannot be used */
  STEIN_IO = 3,               /* a file; nothing in this header reads or writes one */
  STEIN_UNSUPPORTED = 4,      /* well-formed, but not something stein can do */
  STEIN_CANCELLED = 5,        /* the progress callback asked to stop */
  STEIN_OUT_OF_MEMORY = 6,
  STEIN_INTERNAL = 7 /* a defect of stein, or an exception thrown by a callback */
};

/* What went wrong in the last call of this thread that failed; "" if none did. Valid until another one fails. */
STEIN_API const char* stein_error_message(void);

STEIN_API int32_t stein_version(void);

/* ---- Frame ------------------------------------------------------------------------------------------------------ */

typedef int32_t stein_type;
enum { STEIN_FLOAT32 = 0, STEIN_FLOAT16 = 1, STEIN_UINT32 = 2 };

typedef struct stein_frame stein_frame;

/* All planes of a frame are width x height, each 1 to 2^20. */
STEIN_API stein_status stein_frame_create(int32_t width, int32_t height, stein_frame** frame);
STEIN_API void stein_frame_destroy(stein_frame* frame);

/* Declares a feature, such as "albedo" or "depth", with 1 to 4 channels, so that its planes can be set. */
STEIN_API stein_status stein_frame_add_feature(stein_frame* frame, const char* name, int32_t channels);

/* Declares a layer that is to be filtered as the colour is. 3 channels are light, <layer>.R .G .B: what such parts of
 * the colour sum up to before, they do after. 1 channel is alpha or another share, its plane has the layer's name. */
STEIN_API stein_status stein_frame_add_layer(stein_frame* frame, const char* name, int32_t channels);

/* Sets a plane, or replaces it. The memory is neither copied nor owned: it must stay until the frame is destroyed or
 * the plane is replaced, and as it is while stein_denoise runs. A stride of 0 means packed (pixel: the size of an
 * element; row: width times the pixel stride). Names:
 *
 *   R G B                                         mean colour                                              needed
 *   variance.R .G .B                              variance of that mean                                    needed
 *   covariance.R.G .R.B .G.B                      covariances of the means, all three or none
 *   sampleCount                                   samples of each pixel; or stein_frame_set_sample_count   needed
 *   <feature>.<c>                                 mean of a feature
 *   <feature>.variance.<c>                        variance of that mean, for all of its channels or none
 *   covariance.R.<feature>.<c>, also with G, B    covariances with the colour, all or none; next to variances only
 *   <layer>.R .G .B, or <layer>                   mean of a layer
 *
 * with c, for a single channel, V for visibility and Z for any other; for several, R G B A in names that contain
 * "albedo" or "colo", else X Y Z W. A name that is none of these is an error, whose message lists those that the frame
 * can have. */
STEIN_API stein_status stein_frame_set_plane(stein_frame* frame, const char* name, stein_type type, const void* data,
                                             ptrdiff_t pixel_stride, ptrdiff_t row_stride);

/* Copies a plane that the frame has into the caller's memory, as floats, with strides as for stein_frame_set_plane. */
STEIN_API stein_status stein_frame_copy(const stein_frame* frame, const char* name, float* to, ptrdiff_t pixel_stride,
                                        ptrdiff_t row_stride);

/* Samples of every pixel, >= 1. Of this and the plane sampleCount, what was set last holds. */
STEIN_API stein_status stein_frame_set_sample_count(stein_frame* frame, float samples);

/* Of the variances, where these do not come from single samples: K - 1 for the spread of K renders. 0, as at the
 * beginning: one less than samples. */
STEIN_API stein_status stein_frame_set_degrees_of_freedom(stein_frame* frame, float degrees);

/* ---- Parameters ------------------------------------------------------------------------------------------------- */

typedef struct stein_params stein_params;

/* `filter` is a name as on the command line, such as "cross-bilateral"; null is the default filter. */
STEIN_API stein_status stein_params_create(const char* filter, stein_params** params);
STEIN_API void stein_params_destroy(stein_params* params);

/* Options have the names, values and defaults of the command line. An unknown one, one that the filter does not have,
 * or a value out of range is an error. Texts:
 *
 *   bank            final, intermediate (cheaper, for use between batches of samples)
 *   spatial-sigmas  of the candidates, such as 1,2,4; range-sigmas as well
 *   distance        absolute, variance-normalised (of cross-nlm)
 *   order           0, 1, 3, adaptive (of adaptive-order)
 *   order-error     risk, taylor (of adaptive-order)
 *   quality         fast, default, best: takes the place of the filters and what was set of them
 *   risk            auto, sure, joint, monte-carlo
 *   selection       evidence, argmin
 *   density-rule    next-samples, all-samples, error-reduction
 *   scratch         folder of scratch files, once max-memory is set; $TMPDIR, or /var/tmp, unless given */
STEIN_API stein_status stein_params_set_text(stein_params* params, const char* name, const char* value);

/* Numbers; whole ones where they count:
 *
 *   feature-sigma.<feature>  how strongly a feature of the frame guides; smaller is stronger, 0: not at all
 *   range-sigma              range term on the colour, in radiance; 0: off
 *   other-feature-sigma, min-feature-variance, feature-smoothing, spatial-sigma, window-radius, patch-radius,
 *   patch-blur, noise-threshold, ridge, curvature-ridge, levels, value-sigma, fixed-weight, noise-margin, weight-steps,
 *   plain (0 or 1):          parameters of the filters that have them (stein/filters.hpp)
 *   strength                 0 (the input) to 1 (the reconstruction)
 *   draws, seed              of the Monte Carlo risk: 1 to 16 runs; 0 to 2^53
 *   outliers, strict         0 or 1: scale fireflies down; fail on values that would be repaired
 *   second-pass              0 or 1: filter the result once more, for one more picture in the mixture
 *   threads                  most threads to use; 0: all
 *   tile-width, tile-height  of a unit of work, 16 and 1 to 4096; 0: default. Never change the result
 *   max-memory               bytes that the process may hold, 2^27 to 2^60; 0: no limit. What stein makes beyond that
 *                            lies in scratch files; planes of the caller are left where they are */
STEIN_API stein_status stein_params_set_number(stein_params* params, const char* name, double value);

/* Another denoiser, whose image is mixed with those of the filters where it is the better one (docs/candidates.md).
 * Called in the thread that called stein_denoise, with the frame that this got, unusable values included, and `draws`
 * times with a perturbed one, whose planes stein_frame_copy gives; both last only as long as the call. `colour`: planes
 * R, G, B of its size to fill, `row_stride` bytes from row to row. Has to give the same for the same. Returns nonzero,
 * or 0 if it failed: stein_denoise then returns STEIN_INVALID_ARGUMENT. */
typedef int (*stein_denoiser)(const stein_frame* frame, float* const colour[3], ptrdiff_t row_stride, void* user);

/* Adds one, by a name for report and messages. `draws`: 1 to 16; 1 is enough. `step`: of the perturbation in standard
 * deviations of the noise, 0.001 to 1; 0: the default. With one, the frame can have no layers. One that clearly does
 * not follow the perturbation is refused by stein_denoise: it has to denoise what it is handed, the same way always. */
STEIN_API stein_status stein_params_add_denoiser(stein_params* params, const char* name, stein_denoiser denoiser,
                                                 void* user, int32_t draws, float step, uint64_t seed);

/* ---- Denoising -------------------------------------------------------------------------------------------------- */

/* Called with the fraction done, 0 to 1, never decreasing, one call at a time, from any working thread. Returns
 * nonzero to go on, 0 to cancel: stein_denoise then soon returns STEIN_CANCELLED. */
typedef int (*stein_progress)(double done, void* user);

typedef struct stein_result stein_result;

/* `params` may be null for the defaults, `progress` for no calls. Bit-identical for any number of threads. */
STEIN_API stein_status stein_denoise(const stein_frame* frame, const stein_params* params, stein_progress progress,
                                     void* user, stein_result** result);
STEIN_API void stein_result_destroy(stein_result* result);

/* Planes of a result: R G B, error.R .G .B (squared error that is estimated to remain), choice.V (index
 * of the entry that weighs most; -1 where a pixel had no usable colour and was filled), density.V (where samples are
 * worth most; mean 1), and those of the frame's layers.
 *
 * Borrowed: floats without gaps in a row, valid until the result is destroyed. */
STEIN_API stein_status stein_result_plane(const stein_result* result, const char* name, const float** data,
                                          ptrdiff_t* row_stride);

/* Copied into the caller's memory, with strides as for stein_frame_set_plane. It may be the memory of the frame. */
STEIN_API stein_status stein_result_copy(const stein_result* result, const char* name, float* to,
                                         ptrdiff_t pixel_stride, ptrdiff_t row_stride);

/* Numbers of the report: invalid_pixels, single_sample_pixels, outlier_pixels, outlier_energy, mean_error.R .G .B,
 * mean_relative_error, scratch_bytes, bad_layer_pixels (values of all layers that were filled from their neighbours);
 * and of each filter and added denoiser, of the first of a name, weight.NAME, its mean weight in the mixture, and
 * mean_relative_error.NAME, the estimate for its picture alone, which is a lower bound as far as it has no weight (not
 * where the strength is below 1). */
STEIN_API stein_status stein_result_number(const stein_result* result, const char* name, double* value);

/* Texts of the report, by index from 0; past the last one *text becomes null. `name` is one of: warning (in words, for
 * people), candidate (what choice.V says), filter, risk and risk_reason (one
 * for each filter and added denoiser: its name, how its errors were estimated, and why so). Valid until the result is
 * destroyed. */
STEIN_API stein_status stein_result_text(const stein_result* result, const char* name, int32_t index,
                                         const char** text);

/* ---- Film ------------------------------------------------------------------------------------------------------- */

typedef struct stein_film stein_film;

/* Means, variances and covariances of colour and `features` features of the given names and channels. Takes 8 bytes
 * per pixel for each of them, and 32. */
STEIN_API stein_status stein_film_create(int32_t width, int32_t height, const char* const* names,
                                         const int32_t* channels, int32_t features, stein_film** film);
STEIN_API void stein_film_destroy(stein_film* film);

/* One sample: R, G, B, then the channels of the features in their order. Different pixels may be added to at the same
 * time. A colour that is not finite is refused and counted; a feature that is not finite counts as 0. */
STEIN_API stein_status stein_film_add(stein_film* film, int32_t x, int32_t y, const float* sample);

/* Takes over all samples of a film of the same size and features. */
STEIN_API stein_status stein_film_merge(stein_film* film, const stein_film* other);

/* Numbers: rejected (samples refused), repaired (samples with a feature taken as 0). */
STEIN_API stein_status stein_film_number(const stein_film* film, const char* name, double* value);

/* What stein_denoise needs, as of now, in a frame that has its own memory. */
STEIN_API stein_status stein_film_frame(const stein_film* film, stein_frame** frame);

#ifdef __cplusplus
}
#endif

#endif
