# SPDX-License-Identifier: Apache-2.0
"""All nodes that are judged, and their probes, by what a host shows and by a node's kind."""

from collections.abc import Mapping

from mxeon.conformance.nodes import bsdf, emission, kinds, transmission, utilities
from mxeon.conformance.nodes.combinations import COMBINED_NODES
from mxeon.conformance.nodes.diffuse import SUBJECTS, SURFACES
from mxeon.conformance.nodes.hair import HAIRS
from mxeon.conformance.nodes.media import MEDIUM_NODES
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.nodes.subsurface import SUBSURFACES
from mxeon.conformance.nodes.surface_shaders import SHADERS
from mxeon.conformance.nodes.thin_films import FILMS
from mxeon.conformance.probes.bsdf import (
    BsdfProbe,
    CombinedProbe,
    FittedProbe,
    MicrofacetProbe,
    TransmissionProbe,
)
from mxeon.conformance.probes.closures import closures_of
from mxeon.conformance.probes.emission import (
    ConeProbe,
    EmissionPictureProbe,
    EmissionProbe,
    MediumProbe,
    NodeProbe,
    SurfaceEmissionProbe,
)
from mxeon.conformance.probes.hair import HairProbe
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.probes.pictures import (
    DiffuseLobeProbe,
    DrawnBsdfProbe,
    DrawnLobeProbe,
    DrawnProbe,
    HalfBsdfProbe,
    HalfLobeProbe,
    HalfProbe,
    PictureProbe,
)
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.probes.rendered import RenderedLobeProbe, TracedSamples, rendered_of
from mxeon.conformance.probes.renderer_nodes import (
    CoarseFacetProbe,
    ExactProbe,
    FacetPairProbe,
    FacetProbe,
    NativeProbe,
)
from mxeon.conformance.probes.subsurface import SubsurfaceProbe
from mxeon.conformance.probes.surface_shaders import SurfaceShaderProbe
from mxeon.conformance.probes.thin_films import FilmProbe
from mxeon.conformance.probes.utilities import UtilityOslProbe, UtilityProbe
from mxeon.hosts import host_row

# Every run judges the common ones; the others are judged where they are asked for by name.
COMMON_SUBJECTS: tuple[Subject, ...] = (*bsdf.BSDFS, *COMBINED_NODES)
EMISSION_SUBJECTS: tuple[Subject, ...] = (
    *emission.EDFS,
    *emission.COMBINED_EDFS,
    *MEDIUM_NODES,
    *emission.SURFACE_NODES,
    *emission.ABSENT_NODES,
)
PBR_SUBJECTS: tuple[Subject, ...] = (
    *COMMON_SUBJECTS,
    *HAIRS,
    *EMISSION_SUBJECTS,
    *transmission.TRANSMITTING,
    *SUBSURFACES,
    *FILMS,
    *utilities.UTILITY_SUBJECTS,
    *SHADERS,
)
ALL_SUBJECTS: tuple[Subject, ...] = (*SUBJECTS, *PBR_SUBJECTS, *SURFACES)

ClosureProbe = closures_of(PairProbe)
RenderedProbe = rendered_of(PairProbe)
# By the word of a host's row for how it is asked.
HOST_PROBES: dict[str, type[PairProbe] | type[PictureProbe]] = {
    "pairs": PairProbe,
    "closures": ClosureProbe,
    "pictures": PictureProbe,
    "rendered": RenderedProbe,
    "drawn pictures": DrawnProbe,
    "half pictures": HalfProbe,
    "native": NativeProbe,
    "exact": ExactProbe,
    "facets": FacetProbe,
    "coarse facets": CoarseFacetProbe,
    "facet pairs": FacetPairProbe,
}
BSDF_KINDS = (*kinds.BSDFS, kinds.COMBINED, kinds.NESTED)
# Probes of nodes that shine by themselves or of which it is only asked whether they are there.
IN_THE_DARK: Mapping[str, type[Probe]] = {
    kinds.MEDIUM: MediumProbe,
    kinds.EMITTING_SURFACE: SurfaceEmissionProbe,
    kinds.ABSENT: NodeProbe,
}
PICTURED = (kinds.LOBE, kinds.EMITTING_SURFACE)  # kinds whose probes ask for pictures
# On a host that evaluates pairs of directions.
EVALUATED: Mapping[str, type[Probe]] = {
    kinds.LOBE: DiffuseLobeProbe,
    **dict.fromkeys((kinds.CLOSED, kinds.SHEEN), BsdfProbe),
    kinds.FITTED: FittedProbe,
    **dict.fromkeys(kinds.MICROFACETS, MicrofacetProbe),
    **dict.fromkeys((kinds.COMBINED, kinds.NESTED), CombinedProbe),
    kinds.HAIR: HairProbe,
    kinds.SUBSURFACE: SubsurfaceProbe,
    kinds.FILM: FilmProbe,
    **dict.fromkeys(kinds.TRANSMISSIONS, TransmissionProbe),
    **dict.fromkeys(kinds.EMISSIONS, EmissionProbe),
    kinds.CONE_EMISSION: ConeProbe,
    **IN_THE_DARK,
    kinds.UTILITY: UtilityProbe,
    kinds.SURFACE_SHADER: SurfaceShaderProbe,
}
# By the class of a host's own probes, then by the kind of a node. A picture of a solid shows light that
# enters and leaves it, which no equation of a node that transmits has.
PROBES: Mapping[type[Probe], Mapping[str, type[Probe]]] = {
    PairProbe: EVALUATED,
    ClosureProbe: {
        kind: closures_of(probe) for kind, probe in EVALUATED.items() if kind not in PICTURED
    },
    PictureProbe: {
        **{kind: rendered_of(EVALUATED[kind], TracedSamples) for kind in BSDF_KINDS},
        **dict.fromkeys(kinds.EMISSIONS, EmissionPictureProbe),
        **IN_THE_DARK,
        kinds.UTILITY: UtilityOslProbe,
    },
    RenderedProbe: {
        **{kind: rendered_of(EVALUATED[kind]) for kind in (*BSDF_KINDS, kinds.SUBSURFACE)},
        kinds.LOBE: RenderedLobeProbe,
    },
    DrawnProbe: {kinds.LOBE: DrawnLobeProbe, **dict.fromkeys(kinds.BSDFS, DrawnBsdfProbe)},
    # Storm takes an enumerated input for its default: no node of another mode is shown there.
    HalfProbe: {
        kinds.LOBE: HalfLobeProbe,
        **dict.fromkeys((kinds.CLOSED, kinds.FITTED, *kinds.MICROFACETS), HalfBsdfProbe),
    },
}


def probe_type(host: str) -> type[PairProbe] | type[PictureProbe] | None:
    """Class of the probes of the host of a name, or None where only text is checked."""
    return HOST_PROBES.get(host_row(host).probe)


def probe_type_of(subject: Subject, probe: type[Probe]) -> type[Probe] | None:
    """Class of a subject's probes on a host whose own probes have a class; None if it has none."""
    if subject.kind == kinds.DIFFUSE:  # a rough diffuse node, of which each host has a probe
        return probe
    return PROBES.get(probe, {}).get(subject.kind)
