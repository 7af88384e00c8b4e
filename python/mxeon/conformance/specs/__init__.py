# SPDX-License-Identifier: Apache-2.0
"""All nodes that the conformance suite judges. Each module covers a family of nodes."""

from mxeon.conformance.spec import Spec
from mxeon.conformance.specs.clients import CLIENT_FRAME
from mxeon.conformance.specs.combinations import COMBINED_SPECS
from mxeon.conformance.specs.diffuse import DIFFUSE, SURFACE_LOBES
from mxeon.conformance.specs.emission import ABSENT, EMISSION_SPECS, EMITTING_SURFACES, MEDIUM_SPECS
from mxeon.conformance.specs.hair import HAIR
from mxeon.conformance.specs.lobes import BURLEY, TRANSLUCENT
from mxeon.conformance.specs.microfacets import FACET_SPECS, FILM_SPECS, TRANSMISSION_SPECS
from mxeon.conformance.specs.sheen import CONTY_KULLA, ZELTNER
from mxeon.conformance.specs.subsurface import SUBSURFACE
from mxeon.conformance.specs.surface_shaders import SURFACE_SHADERS
from mxeon.conformance.specs.surface_texts import SENTENCES
from mxeon.conformance.specs.utilities import INVERSION_SPECS, UTILITY_SPECS

PLAIN_LOBES = (BURLEY, TRANSLUCENT, CONTY_KULLA, ZELTNER, *FACET_SPECS)
# Every run judges the nodes of COMMON. All other nodes must be named by the user.
COMMON: tuple[Spec, ...] = (*PLAIN_LOBES, *COMBINED_SPECS, *INVERSION_SPECS, CLIENT_FRAME)
# fmt: off
PBRLIB: tuple[Spec, ...] = (
    *COMMON, HAIR, *EMISSION_SPECS, *MEDIUM_SPECS, *EMITTING_SURFACES, *ABSENT, *TRANSMISSION_SPECS,
    SUBSURFACE, *FILM_SPECS, *UTILITY_SPECS, *SURFACE_SHADERS,
)
# fmt: on
# The sentences of a specification are judged only if the user names the specification.
ALL: tuple[Spec, ...] = (*DIFFUSE, *PBRLIB, *SURFACE_LOBES, *SENTENCES)
