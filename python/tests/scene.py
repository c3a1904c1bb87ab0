# SPDX-License-Identifier: Apache-2.0
"""A step edge with noise of known variance, and the feature that shows it."""

import numpy as np

HEIGHT, WIDTH, SAMPLES, DEVIATION = 24, 40, 8, 0.1


class Scene:
    def __init__(self, seed: int = 1) -> None:
        random = np.random.default_rng(seed)
        step = (np.arange(WIDTH) >= WIDTH // 2).astype(np.float32)
        self.truth = np.broadcast_to(0.25 + 0.5 * step[None, :, None], (HEIGHT, WIDTH, 3)).astype(np.float32)
        noise = random.normal(0, DEVIATION, self.truth.shape).astype(np.float32)
        self.colour = self.truth + noise
        self.variance = np.full_like(self.truth, DEVIATION**2)
        self.albedo = self.truth.copy()
        self.albedo_variance = np.full_like(self.truth, 1e-4)

    def arguments(self) -> dict:
        return {
            "colour": self.colour,
            "variance": self.variance,
            "features": {"albedo": (self.albedo, self.albedo_variance)},
            "samples": SAMPLES,
        }
