# SPDX-License-Identifier: Apache-2.0
"""Surface shaders as specified: OpenPBR, Standard Surface, glTF and UsdPreviewSurface.

Each module has the specification's `DEFAULTS`, a function `parameters` that fills in defaults, and the functions
`surface` and `emission`, in float64:

    >>> import numpy as np
    >>> from mxeon.models.surfaces import Light, open_pbr
    >>> view, sun = np.array([[0.6, 0.0, 0.8]]), np.array([[0.0, 0.0, 1.0]])
    >>> p = open_pbr.parameters(base_color=(0.8, 0.4, 0.1), specular_roughness=0.5)
    >>> open_pbr.surface(Light(view, sun), p).round(4)  # f cos(theta_i), in sunlight
    array([[0.2543, 0.1323, 0.0408]])
    >>> open_pbr.surface(Light(view), p).round(4)  # response to a white environment
    array([[0.8084, 0.4251, 0.1376]])

Surface shaders do not check the ranges of parameters, but the models that they call raise
`ValueError` for arguments out of range.
"""

from mxeon.models.surfaces.lobes import Frame as Frame
from mxeon.models.surfaces.lobes import Light as Light
