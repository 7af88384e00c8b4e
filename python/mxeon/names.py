# SPDX-License-Identifier: Apache-2.0
"""Names that must be known: the message about one that is not, with the one that was meant."""

from collections.abc import Iterable, Mapping
from difflib import get_close_matches

LISTED = 20  # known names of a message, unless one of more is near
SOME = 4  # names that one word may mean
NONE: Mapping[str, str] = {}


def meant(
    name: object, known: Iterable[str], alike: float = 0.65, titles: Mapping[str, str] = NONE
) -> str:
    """The end of a message on an unknown name: the known ones that it may stand for, or "".

    >>> meant("cycels", ("gl", "cycles")), meant("EON", ("eon", "fon"))
    (': did you mean cycles?', ': did you mean eon?')
    >>> meant("sheen", ("zeltner", "eon"), titles={"zeltner": "Zeltner sheen"})
    ': did you mean zeltner?'
    """
    word = str(name).lower()
    near = [each for each, title in titles.items() if word in title.lower().split()]
    if not 0 < len(near) <= SOME:
        spelled = {each.lower(): each for each in known}
        near = [spelled[each] for each in get_close_matches(word, spelled, 1, alike)]
    return f": did you mean {' or '.join(near)}?" if near else ""


def unknown(
    rule: str,
    name: object,
    known: Iterable[str],
    titles: Mapping[str, str] = NONE,
    listing: str = "",
) -> str:
    """The message that a name is none of the known; "" if it is one.

    It lists them, unless one of many is near or `listing` says where they are listed.

    >>> unknown("model", "nope", ("eon", "fon"), listing="mxeon.model_names()")
    "no model 'nope'; see mxeon.model_names()"
    """
    names = tuple(known)
    if isinstance(name, str) and name in names:
        return ""
    near = meant(name, names, titles=titles)
    if listing:
        return f"no {rule} {name!r}{near or ';'} see {listing}"
    if near and len(names) > LISTED:
        return f"{rule} must be one of {len(names)} names; got {name!r}{near}"
    return f"{rule} must be one of {', '.join(names)}; got {name!r}{near}"
