# SPDX-License-Identifier: Apache-2.0
"""Subsurface scattering: the diffusion profile blurs the light on a sphere."""

import numpy as np
import pytest

from mxeon.models.media import diffusion_blur


@pytest.mark.parametrize("reach", [0.05, 0.4, 3.0])
def test_a_blur_is_the_profile_s_mean_over_the_unit_sphere(reach):
    # On a sphere, a ring at chord d has the area 2 pi d dd. The profile contains a factor 1 / d.
    x, w = np.polynomial.legendre.leggauss(400)
    d = 1.0 + x
    w = w * (np.exp(-d / reach) + np.exp(-d / (3.0 * reach)))
    phi = 2.0 * np.pi * (np.arange(400) + 0.5) / 400
    along, across = 1.0 - 0.5 * d * d, d * np.sqrt(1.0 - 0.25 * d * d)
    for mu in (-0.6, 0.0, 0.3, 0.95):
        cosine = mu * along[:, np.newaxis] + np.sqrt(1.0 - mu * mu) * np.outer(across, np.cos(phi))
        rings = np.maximum(cosine, 0.0).mean(axis=1)
        # Kinks of the integrands add errors of 400^-2 times the slopes.
        assert diffusion_blur(mu, reach) == pytest.approx(w @ rings / w.sum(), abs=1e-4)
