/* SPDX-License-Identifier: Apache-2.0
 *
 * A renderer in C that denoises a frame with stein: its colours, variances and albedo are interleaved, as RGB, and stay
 * where they are. Prints the error before and after, and what stein estimated it to be. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <stein.h>

enum { WIDTH = 160, HEIGHT = 96, CHANNELS = 3, PIXELS = WIDTH * HEIGHT, SAMPLES = 8 };

typedef struct {
  float truth[PIXELS * CHANNELS];
  float colour[PIXELS * CHANNELS];
  float variance[PIXELS * CHANNELS];
  float albedo[PIXELS * CHANNELS];
} Render;

static const char* const colour_names[CHANNELS] = {"R", "G", "B"};

static double uniform(uint64_t* state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 40) / 16777216.0;
}

/* A chequered floor in a soft light; every pixel is the mean of a few samples, whose variance is measured. */
static void render(Render* image) {
  uint64_t random = 1;
  for (int i = 0; i < PIXELS * CHANNELS; ++i) {
    const int x = i / CHANNELS % WIDTH, y = i / CHANNELS / WIDTH;
    const double light = 0.6 + 0.4 * sin(0.04 * x) * cos(0.05 * y);
    double sum = 0, squares = 0;
    image->albedo[i] = (x / 16 + y / 16) % 2 ? 0.8F : 0.2F;
    image->truth[i] = (float)(image->albedo[i] * light);
    for (int s = 0; s < SAMPLES; ++s) {
      const double sample = image->truth[i] * 2 * uniform(&random);
      sum += sample;
      squares += sample * sample;
    }
    image->colour[i] = (float)(sum / SAMPLES);
    image->variance[i] = (float)((squares - sum * sum / SAMPLES) / (SAMPLES - 1) / SAMPLES);
  }
}

static double mean_squared_error(const Render* image) {
  double sum = 0;
  for (int i = 0; i < PIXELS * CHANNELS; ++i) {
    const double difference = image->colour[i] - image->truth[i];
    sum += difference * difference;
  }
  return sum / (PIXELS * CHANNELS);
}

/* Calls of stein end the program where they fail. */
static void expect(stein_status status) {
  if (status == STEIN_OK) return;
  fprintf(stderr, "%s\n", stein_error_message());
  exit(EXIT_FAILURE);
}

static void set_plane(stein_frame* frame, const char* name, const float* first) {
  expect(stein_frame_set_plane(frame, name, STEIN_FLOAT32, first, CHANNELS * sizeof(float), 0));
}

static stein_frame* describe(const Render* image) {
  static const char* const variance_names[CHANNELS] = {"variance.R", "variance.G", "variance.B"};
  static const char* const albedo_names[CHANNELS] = {"albedo.R", "albedo.G", "albedo.B"};
  stein_frame* frame = NULL;
  expect(stein_frame_create(WIDTH, HEIGHT, &frame));
  expect(stein_frame_set_sample_count(frame, SAMPLES));
  expect(stein_frame_add_feature(frame, "albedo", CHANNELS));
  for (int c = 0; c < CHANNELS; ++c) {
    set_plane(frame, colour_names[c], image->colour + c);
    set_plane(frame, variance_names[c], image->variance + c);
    set_plane(frame, albedo_names[c], image->albedo + c);
  }
  return frame;
}

/* Where a program would draw its bar, and look whether somebody pressed "cancel". */
static int go_on(double done, void* user) {
  *(double*)user = done;
  return 1;
}

static void print_report(const stein_result* result) {
  const char* text = NULL;
  double estimated[CHANNELS];
  expect(stein_result_number(result, "mean_error.R", &estimated[0]));
  expect(stein_result_number(result, "mean_error.G", &estimated[1]));
  expect(stein_result_number(result, "mean_error.B", &estimated[2]));
  printf("estimated to remain: %.3g\n", (estimated[0] + estimated[1] + estimated[2]) / CHANNELS);
  for (int i = 0; expect(stein_result_text(result, "warning", i, &text)), text != NULL; ++i)
    printf("warning: %s\n", text);
}

int main(void) {
  Render* image = malloc(sizeof *image);
  if (image == NULL) return EXIT_FAILURE;
  render(image);
  const double before = mean_squared_error(image);

  stein_frame* frame = describe(image);
  stein_params* params = NULL;
  expect(stein_params_create("cross-bilateral", &params));
  expect(stein_params_set_number(params, "feature-sigma.albedo", 0.2));
  stein_result* result = NULL;
  double done = 0;
  expect(stein_denoise(frame, params, go_on, &done, &result));
  for (int c = 0; c < CHANNELS; ++c)
    expect(stein_result_copy(result, colour_names[c], image->colour + c, CHANNELS * sizeof(float), 0));

  const double after = mean_squared_error(image);
  printf("mean squared error: %.3g before, %.3g after\n", before, after);
  print_report(result);
  stein_result_destroy(result);
  stein_params_destroy(params);
  stein_frame_destroy(frame);
  free(image);
  return done > 0.99 && after < 0.2 * before ? EXIT_SUCCESS : EXIT_FAILURE;
}
