# SPDX-License-Identifier: Apache-2.0
"""Color spaces of a document, under the names by which MaterialX has transforms between them."""

import MaterialX as mx

# Names that MaterialX's own color management takes for others; source: DefaultColorManagementSystem.cpp.
LEGACY = {
    "gamma18": "g18_rec709",
    "gamma22": "g22_rec709",
    "gamma24": "rec709_display",
    "lin_ap1": "acescg",
}
# Those of the Color Interop Forum, from the version on that knows them.
INTEROP_VERSION = (1, 39, 4)
INTEROP = {
    "lin_ap1_scene": "acescg",
    "lin_rec709_scene": "lin_rec709",
    "lin_p3d65_scene": "lin_displayp3",
    "lin_adobergb_scene": "lin_adobergb",
    "srgb_rec709_scene": "srgb_texture",
    "g22_rec709_scene": "g22_rec709",
    "g18_rec709_scene": "g18_rec709",
    "g22_ap1_scene": "g22_ap1",
    "srgb_p3d65_scene": "srgb_displayp3",
    "g22_adobergb_scene": "adobergb",
}


def color_spaces(element: mx.Element) -> tuple[str, str] | None:
    """Color space of an element and of its document; None if MaterialX leaves its values alone.

    Parameters
    ----------
    element : MaterialX.Element
        A value, whose space may be that of an element around it.

    Returns
    -------
    tuple of str, or None
        Two spaces that differ.
    """
    known = LEGACY | (INTEROP if mx.getVersionIntegers() >= INTEROP_VERSION else {})
    space, target = (
        known.get(name, name)
        for name in (element.getActiveColorSpace(), element.getDocument().getColorSpace())
    )
    return None if {"", "none"} & {space, target} or space == target else (space, target)
