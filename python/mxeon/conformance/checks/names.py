# SPDX-License-Identifier: Apache-2.0
"""Names of the models that several checks hold for, and hosts that they leave out."""

from mxeon.conformance.nodes.subject import Subject
from mxeon.hosts import HOSTS
from mxeon.models.nodes import NODES
from mxeon.models.nodes.combinations import COMBINATIONS
from mxeon.models.nodes.emissions import COMBINED_EMISSIONS, EMISSIONS
from mxeon.models.nodes.hair import HAIR_NODE
from mxeon.models.nodes.media import COMBINED_MEDIA, MEDIA
from mxeon.models.nodes.subsurface import SUBSURFACE_NODE

FRAMED = (*(row.name for row in NODES), "burley_lambert", HAIR_NODE.name)
# The checked frames turn from pixel to pixel: to subsurface scattering that is a curved surface.
OTHERS = (*FRAMED, SUBSURFACE_NODE.name)
COMBINATION = tuple(row.name for row in COMBINATIONS)
EMITTER = tuple(row.name for row in (*EMISSIONS, *COMBINED_EMISSIONS))
SHOWN = ("rendered", "pictures")  # of a host whose camera sees nothing on the horizon
MEDIUM_NAMES = tuple(row.name for row in (*MEDIA, *COMBINED_MEDIA))


def shows_exactly(subject: Subject, host: str) -> bool:
    """Whether a host has directions to the last bit, those on the horizon too."""
    return all(row.probe not in SHOWN for row in HOSTS if row.name == host)
