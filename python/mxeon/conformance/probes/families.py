# SPDX-License-Identifier: Apache-2.0
"""The nodes of pbrlib that are judged beside the rough diffuse ones, and the probes that they take."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from mxeon.conformance.nodes.bsdf import BSDFS
from mxeon.conformance.nodes.combinations import COMBINED_NODES
from mxeon.conformance.nodes.emission import COMBINED_EDFS, EDFS, KINDS
from mxeon.conformance.nodes.emission_surfaces import ABSENT_NODES, SURFACE_NODES
from mxeon.conformance.nodes.hair import HAIRS
from mxeon.conformance.nodes.media import MEDIUM_NODES
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.nodes.subsurface import SUBSURFACES
from mxeon.conformance.nodes.surface_shaders import SHADERS
from mxeon.conformance.nodes.thin_films import FILMS
from mxeon.conformance.nodes.transmission import TRANSMITTING
from mxeon.conformance.nodes.utilities import UTILITY_SUBJECTS
from mxeon.conformance.probes.bsdf_pictures import bsdf_probe_type
from mxeon.conformance.probes.emission import PROBES
from mxeon.conformance.probes.emission_pictures import EmissionPictureProbe
from mxeon.conformance.probes.emission_surfaces import AbsentProbe, SurfaceEmissionProbe
from mxeon.conformance.probes.hair import HairProbe
from mxeon.conformance.probes.media import MediumProbe
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.probes.pictures import PictureProbe
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.probes.subsurface import SubsurfaceProbe
from mxeon.conformance.probes.surface_shaders import SurfaceShaderProbe
from mxeon.conformance.probes.thin_films import FilmProbe
from mxeon.conformance.probes.transmission import transmission_probe_type
from mxeon.conformance.probes.utilities import utility_probe_type

ProbeType: TypeAlias = Callable[[Subject, type[Probe]], type[Probe] | None]


@dataclass(frozen=True)
class Family:
    """Subjects that share a way of probing.

    Attributes
    ----------
    subjects : tuple
        Each has `title` and `node`, the category; a title is of one subject.
    probe_type : callable (subject, probe) -> type or None
        Class of a subject's probes on a host that has probes of a class; None if it has none.
    common : bool
        Whether every run judges them; others are judged where they are asked for by name.
    """

    subjects: tuple[Subject, ...]
    probe_type: ProbeType
    common: bool = False


def on_pairs(kind: type[Probe]) -> ProbeType:
    """Class of probes of subjects that need a host that evaluates any pairs."""
    return lambda subject, probe: kind if probe is PairProbe else None


EMISSION_SUBJECTS: tuple[Subject, ...] = (
    *EDFS,
    *COMBINED_EDFS,
    *MEDIUM_NODES,
    *SURFACE_NODES,
    *ABSENT_NODES,
)


ALL_PROBES = {
    **PROBES,
    **{probe.kind: probe for probe in (MediumProbe, SurfaceEmissionProbe, AbsentProbe)},
}


def emission_probe_type(subject: Subject, probe: type[Probe]) -> type[Probe] | None:
    """Class of a subject's probes on a host that has probes of a class; None if it has none."""
    if probe is PictureProbe and subject.kind in KINDS:
        return EmissionPictureProbe
    return ALL_PROBES[subject.kind] if probe in (PairProbe, PictureProbe) else None


FAMILIES = (
    Family((*BSDFS, *COMBINED_NODES), bsdf_probe_type, common=True),
    Family(HAIRS, on_pairs(HairProbe)),
    Family(EMISSION_SUBJECTS, emission_probe_type),
    Family(TRANSMITTING, transmission_probe_type),
    Family(SUBSURFACES, on_pairs(SubsurfaceProbe)),
    Family(FILMS, on_pairs(FilmProbe)),
    Family(UTILITY_SUBJECTS, utility_probe_type),
    Family(SHADERS, on_pairs(SurfaceShaderProbe)),
)
PBR_SUBJECTS = tuple(subject for family in FAMILIES for subject in family.subjects)
COMMON_SUBJECTS = tuple(
    subject for family in FAMILIES if family.common for subject in family.subjects
)


def probe_type_of(subject: Subject, probe: type[Probe]) -> type[Probe] | None:
    """Class of the probes of one of PBR_SUBJECTS on a host that has probes of a class, or None."""
    [family] = (family for family in FAMILIES if subject in family.subjects)
    return family.probe_type(subject, probe)
