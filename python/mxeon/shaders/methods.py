# SPDX-License-Identifier: Apache-2.0
"""Lighting methods that an application can choose for MaterialX's rasterizing generators."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace

from mxeon.errors import InputError, NotRun, assert_known

CHOICES = {
    "environment": ("fis", "prefilter", "none"),
    "transmission": ("refraction", "opacity"),
    "albedo": ("analytic", "table", "monteCarlo"),
}
MOST_ITERATIONS = 64
TABLE_SIZE = 64  # rows and columns of MaterialX's table of albedos
# Targets for which MaterialX's shader of the albedo table does not compile. The values are the
# faulty text, the cause, and the page in docs/upstream.
UNTABLED = {
    "essl": ("xy / u_albedoTableSize", "divides a vec2 by an int", "genessl_albedo_table"),
    "wgsl": ("texture(u_albedoTable,", "reads an undeclared sampler", "genwgsl_albedo_table"),
}
# The command-line option of each method.
OPTIONS = {
    "environment": "--environment",
    "transmission": "--transmission",
    "albedo": "--albedo",
    "airy": "--airyIterations",
    "premultiplied": "--premultipliedAdd",
    "distributed": "--distributeLayers",
    "searched": "--searchEnvironment",
}


@dataclass(frozen=True)
class Methods:
    """The methods that an application chooses; "", 0 and None leave a choice to the host.

    - `environment`: Specular environment lighting: "fis", "prefilter" or "none".
    - `transmission`: "refraction" of the environment, or "opacity".
    - `albedo`: Directional albedos of MaterialX's functions: "analytic", "table" or "monteCarlo".
    - `airy`: Number of Airy iterations in MaterialX's own thin films.
    - `premultiplied`: Whether a `mix` node scales the weights of its lobes instead of the lobes'
      values (premultipliedBsdfAdd).
    - `distributed`: Whether a `layer` node is distributed over a `mix` node
      (distributeLayerOverBsdfMix).
    - `searched`: Whether sources are looked up first in the library's `genglsl/environment`.
    """

    environment: str = ""
    transmission: str = ""
    albedo: str = ""
    airy: int = 0
    premultiplied: bool | None = None
    distributed: bool | None = None
    searched: bool | None = None

    def __post_init__(self) -> None:
        for name, known in CHOICES.items():
            if value := getattr(self, name):
                assert_known(name, value, known)
        if not 0 <= self.airy <= MOST_ITERATIONS:
            raise InputError(f"airy must lie in [1, {MOST_ITERATIONS}]; got {self.airy}")

    def over(self, host: "Methods") -> "Methods":
        """The chosen methods, completed by the methods of `host`."""
        return replace(host, **dict(self.chosen()))  # type: ignore[arg-type]

    def chosen(self) -> Iterator[tuple[str, str | int | bool]]:
        """Names and values of the chosen methods."""
        for each in fields(self):
            value = getattr(self, each.name)
            if value is not None and (value or isinstance(value, bool)):
                yield each.name, value

    @property
    def settings(self) -> dict[str, str | int | bool]:
        """Names and values of the chosen methods that are options of the generator."""
        return {name: value for name, value in self.chosen() if name != "searched"}

    @property
    def options(self) -> dict[str, str]:
        """Values of the chosen methods, keyed by command-line option."""
        return {OPTIONS[name]: str(value).lower() for name, value in self.chosen()}

    def __str__(self) -> str:
        return ", ".join(f"{name} {str(value).lower()}" for name, value in self.chosen())


UNCHOSEN = Methods()  # leaves all choices to the host
GENERATED = Methods("fis", "refraction", "analytic", 2)  # the defaults of MaterialX's generators
STORM = Methods("prefilter", "opacity", "analytic", 2)  # methods of USD in materialXFilter.cpp

# Match the declarations of methods in generated text.
ALBEDO = re.compile(r"^#define DIRECTIONAL_ALBEDO_METHOD (\d+)$", re.MULTILINE)
ITERATIONS = re.compile(r"^#define AIRY_FRESNEL_ITERATIONS (\d+)$", re.MULTILINE)
REFRACTS = re.compile(r"if \((\w*refractionTwoSided)\)")  # only refraction has this test


def assert_generated(text: str, methods: Methods) -> None:
    """Raise NotRun unless the text of a pixel stage is complete and uses the chosen methods."""
    found: dict[str, str | int] = {}
    if numbers := ALBEDO.findall(text):
        found["albedo"] = CHOICES["albedo"][int(numbers[0])]
    if numbers := ITERATIONS.findall(text):
        found["airy"] = int(numbers[0])
    two_sided = REFRACTS.search(text)
    if "mx_surface_transmission(" in text:
        found["transmission"] = "refraction" if two_sided else "opacity"
    if "mx_environment_radiance(" in text:
        prefiltered, sampled = "mx_latlong_alpha_to_lod(" in text, "lod = mx_latlong_compute_lod("
        found["environment"] = "prefilter" if prefiltered else "fis" if sampled in text else "none"
    chosen = methods.over(GENERATED)
    for name, value in found.items():
        if value != getattr(chosen, name):
            raise NotRun(f"{name}: MaterialX's generator wrote {value} instead of {methods}")
    if two_sided and len(re.findall(rf"\b{two_sided[1]}\b", text)) == 1:
        raise NotRun(
            "environment none with transmission refraction: MaterialX's shader reads "
            f"{two_sided[1]} without declaring it"
        )
