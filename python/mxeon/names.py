# SPDX-License-Identifier: Apache-2.0
"""Messages about unknown names. The messages suggest similar known names."""

from collections.abc import Iterable, Mapping
from difflib import get_close_matches

LISTED = 20  # maximum number of known names in a message, unless a similar name is known
SOME = 4  # maximum number of suggestions for one word
NONE: Mapping[str, str] = {}


def meant(
    name: object, known: Iterable[str], alike: float = 0.65, titles: Mapping[str, str] = NONE
) -> str:
    """The end of a message about an unknown name, with similar known names, or "" without any.

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
    """The message that a name is unknown, or "" for a known name.

    The message lists the known names, unless there are many names and a similar name is known,
    or unless `listing` states where the names are listed.

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
