# SPDX-License-Identifier: Apache-2.0
"""The quantities whose errors are measured, with units and explanations for readers."""

from enum import Enum

_WHITE = "1 is a white, matte surface that faces the light"
_LARGE = f"{_WHITE}; errors of values above 1 are divided by the value"
_RIM = "weighted by the cosine of the viewing angle, so the rim counts less"
_ALL = "an albedo of 1 returns all light"
_SCALED = "pi f cos, relative above 1"


class Quantity(Enum):
    """A quantity, with a key in results.json, a unit, and the unit's meaning unless obvious."""

    # Values in direct light.
    VALUE = "value", _SCALED, _LARGE
    DIFFERENCE = "difference", "pi f cos", _WHITE
    RELATIVE = "relative", "relative"
    MEAN = "mean", "pi f cos, mean", _WHITE
    RECIPROCITY = "reciprocity", "pi f cos cos", _WHITE
    FULL_SPHERE = "full_sphere", "pi f, relative above 1"
    SLOPES = "slopes", "pi f and its slopes"
    PICTURE = "picture", "pi f cos, times cos(theta_o)", f"{_WHITE}; {_RIM}"
    FITTED_PICTURE = "fitted_picture", f"{_SCALED}, times cos(theta_o)", f"{_LARGE}; {_RIM}"
    KIT = "kit", "times what noise, pixels and the mesh allow"
    # Quantities that do not depend on the light's direction.
    ALBEDO = "albedo", "albedo", _ALL
    MEAN_ALBEDO = "mean_albedo", "mean albedo", _ALL
    VALUE_OR_ALBEDO = "value_or_albedo", "pi f cos or albedo", f"{_WHITE}; {_ALL}"
    MATERIAL_MEAN = "material_mean", f"{_SCALED}, or albedo, mean", f"{_LARGE}; {_ALL}"
    REFLECTANCE = "reflectance", "reflectance"
    REFLECTANCE_RMS = "reflectance_rms", "reflectance, rms"
    # Quantities of incident, transmitted or emitted light.
    LIGHT = "light", "light", "1 is all light"
    THROUGHPUT = "throughput", "throughput", "a throughput of 1 passes all light"
    TRANSMITTANCE = "transmittance", "transmittance"
    IRRADIANCE = "irradiance", "irradiance", "1 is a white environment"
    RADIANCE = "radiance", "radiance"
    RADIANCE_SLOPE = "radiance_slope", "radiance and its slope"
    # Quantities of nodes' outputs, of samples, and of functions.
    OUTPUT = "output", "relative above 1", "errors of values above 1 are divided by the value"
    ALPHA = "alpha", "alpha"
    INDEX = "index", "n (1 - sqrt(r))^2"
    EXTINCTION = "extinction", "k^2 (1 - r) / (n_max + 1)^2"
    DENSITY = "density", "1/sr, relative above 1"
    DEVIATIONS = "deviations", "standard deviations"
    DRAWN = "drawn", "relative, divided by the lobe's slope"
    CONDITIONED = "conditioned", "divided by max(1, |value|) plus the slopes in all arguments"
    TOLERANCES = "tolerances", "tolerances"
    # Counts of faults.
    INPUTS = "inputs", "inputs"
    VALUES = "values", "values"
    FAULTS = "faults", "faults"
    DIFFERENCES = "differences", "differences"
    NODES = "nodes", "nodes"
    FUNCTIONS = "functions", "functions"
    PIXELS = "pixels", "pixels"
    DOCUMENTS = "documents", "documents"

    unit: str
    meaning: str

    def __new__(cls, key: str, unit: str = "", meaning: str = "") -> "Quantity":
        member = object.__new__(cls)
        member._value_, member.unit, member.meaning = key, unit, meaning
        return member

    @property
    def counted(self) -> bool:
        """Whether the quantity is a count of faults, which must be 0."""
        return self.value in COUNTED

    @property
    def of_views(self) -> bool:
        """Whether the quantity depends on the view and not on the light's direction."""
        return self.value in OF_VIEWS


COUNTED = ["inputs", "values", "faults", "differences", "nodes", "functions", "pixels", "documents"]
OF_VIEWS = ["albedo", "mean_albedo", "value_or_albedo", "material_mean"]
