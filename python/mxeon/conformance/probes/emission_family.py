# SPDX-License-Identifier: Apache-2.0
"""All subjects that emit light or are media, and the probes that they take."""

from typing import Any

from mxeon.conformance.nodes.media import (MEDIUM_NODES, MediumProbe)
from mxeon.conformance.probes.emission_pictures import EmissionPictureProbe
from mxeon.conformance.probes.emission import (PROBES, NodeProbe)
from mxeon.conformance.nodes.emission import (COMBINED_EDFS, EDFS, KINDS)
from mxeon.conformance.nodes.emission_surfaces import (ABSENT_NODES, SURFACE_NODES, AbsentProbe, SurfaceEmissionProbe)
from mxeon.conformance.probes.pairs import (PairProbe, PictureProbe)

EMISSION_SUBJECTS = (*EDFS, *COMBINED_EDFS, *MEDIUM_NODES, *SURFACE_NODES, *ABSENT_NODES)
ALL_PROBES = {
    **PROBES,
    **{probe.kind: probe for probe in (MediumProbe, SurfaceEmissionProbe, AbsentProbe)},
}


def emission_probe_type(subject: Any, probe: type[Any]) -> type[NodeProbe] | None:
    """Class of a subject's probes on a host that has probes of a class; None if it has none."""
    if probe is PictureProbe and subject.kind in KINDS:
        return EmissionPictureProbe
    return ALL_PROBES[subject.kind] if probe in (PairProbe, PictureProbe) else None
