# SPDX-License-Identifier: Apache-2.0
"""A run as independent items, each a check of one subject on one host with one library.

An item is a few words and its findings are plain data, so both travel to other processes and
machines. Whoever works on items keeps a `Judge`, which holds what is costly to open.
"""

import os
import platform
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import MaterialX as mx
import moderngl
import numpy as np
import OpenImageIO as oiio

import mxeon
from mxeon.conformance.checks.evaluate import applies, judge_curve, judge_subject, judge_twins
from mxeon.conformance.checks.image import MATCH, judge_document
from mxeon.conformance.checks.nodes import NATIVE, SUBJECTS, SURFACES, Surface
from mxeon.conformance.checks.probes import NativeProbe, PairProbe, SurfaceProbe, probe_type
from mxeon.conformance.checks.source import check_sources
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.known_issues import referred
from mxeon.conformance.reference import Host as Reference
from mxeon.conformance.results import NOT_RUN, Findings, Item, Plan, Result
from mxeon.conformance.run.dependencies import digests
from mxeon.errors import DocumentError, ImageError, InputError, InterfaceError, NotRun
from mxeon.shaders.document.policy import DEFAULT, LIMITS
from mxeon.shaders.hosts import host_names, host_row, open_host
from mxeon.shaders.library import (
    LIBRARIES,
    check_version,
    examples_folder,
    library_name,
    load_library,
)

HOST, SOURCE, CURVE, PICTURE = "host", "source", "curve", "picture"
TWINS, EVERY_NODE = "shader twins", "every node"
ROWS = {check.key: check for check in CHECKS}
CLAIMS = {key: check.claim for key, check in ROWS.items()} | {
    HOST: "The host executes shaders here.",
    SOURCE: "The generated text was checked.",
    CURVE: "The albedo was measured over the cosine.",
    PICTURE: MATCH,
}


def plan(files, hosts, libraries, policy=DEFAULT, resumable=False):
    """The items of a run, those of one host and library beside each other.

    Parameters
    ----------
    files : sequence of path-like
        Documents; none for the bundled examples.
    hosts, libraries : sequence of str
    policy : Policy
    resumable : bool
        Whether the plan has to say which files the run depends on.

    Returns
    -------
    Plan

    Raises
    ------
    ValueError
        If a host or a library is unknown; lists the known ones.
    ImportError
        If this MaterialX is too old.
    """
    check_version()
    _known("host", hosts, host_names())
    libraries = tuple(dict.fromkeys(map(library_name, libraries)))
    items, documents = [], []
    for library in libraries:
        named = [Path(file) for file in files] or _examples(library)
        documents += map(str, named)
        items.append(Item(SOURCE, EVERY_NODE, SOURCE, library))
        for host in dict.fromkeys(hosts):
            items += _on_host(host, library, named)
    items += [item for host in dict.fromkeys(hosts) for item in _native(host)]
    documents = tuple(dict.fromkeys(documents))
    files = digests(documents, policy, libraries) if resumable else {}
    return Plan(mxeon.__version__, _software(), tuple(items), documents, _options(policy), files)


def subjects(library):
    """The nodes that a library has."""
    data = load_library(library)
    return [subject for subject in SUBJECTS if data.getMatchingNodeDefs(subject.node)]


def not_run(item, reason):
    """Findings of an item that could not be worked on."""
    claim = CLAIMS[item.check]
    place = (item.subject, item.host, item.library)
    return Findings(results=(Result(item.check, claim, *place, NOT_RUN, reason=reason),))


class Judge:
    """Works on items, one after the other, and keeps the hosts it opens.

    Parameters
    ----------
    policy : Policy
        What documents may do, and how large they may be.
    """

    def __init__(self, policy):
        self._permissions = policy
        self._hosts = {}
        self._reference = Reference()
        self._probe = lru_cache(maxsize=1)(_probe)  # a million pairs each

    def work(self, item):
        """Findings of an item.

        Parameters
        ----------
        item : Item

        Returns
        -------
        Findings
            A document that cannot be read is among its errors.

        Raises
        ------
        NotRun
            If the host cannot be opened here.
        """
        try:
            return _with_ledger(Findings(**self._findings(item)))
        except InterfaceError as reason:
            return not_run(item, str(reason))

    def close(self):
        """Close what was opened."""
        for host in self._hosts.values():
            if not isinstance(host, NotRun):
                host.close()

    def _host(self, name):
        """The host of that name; it is opened, or found missing, once."""
        if name not in self._hosts:
            try:
                self._hosts[name] = open_host(name)
            except NotRun as reason:
                self._hosts[name] = reason
        if isinstance(self._hosts[name], NotRun):
            raise self._hosts[name]
        return self._hosts[name]

    def _findings(self, item):
        if item.check == SOURCE:
            return {"results": check_sources(subjects(item.library), item.library)}
        host = self._host(item.host)
        return self._on_host(item, host) | {"hosts": (host.identity(),)}

    def _on_host(self, item, host):
        if item.check == PICTURE:
            return self._document(item, host)
        if item.subject == TWINS:
            return {"results": judge_twins(host, item.library, (ROWS[item.check],))}
        probe = self._probe(host, item.subject, item.library)
        if item.check == CURVE:
            return {"curves": judge_curve(probe)}
        return {"results": judge_subject(probe, (ROWS[item.check],))}

    def _document(self, item, host):
        path = Path(item.subject)
        try:
            found = judge_document(path, host, self._reference, item.library, self._permissions)
        except (DocumentError, ImageError) as error:
            return {"errors": (str(error),)}
        return dict(zip(("results", "pictures", "notes"), found, strict=True))


def _with_ledger(findings):
    """Findings whose failures name their pages of the ledger."""
    return replace(findings, results=tuple(map(referred, findings.results)))


def _probe(host, title, library):
    subject = next(each for each in SUBJECTS + NATIVE + SURFACES if each.title == title)
    kind = SurfaceProbe if isinstance(subject, Surface) else probe_type(host.name)
    return kind(host, subject, library)


def _on_host(host, library, files):
    probe = probe_type(host)
    if not probe:
        yield Item(HOST, EVERY_NODE, host, library)
    if not probe or probe is NativeProbe:
        return
    kind = probe.kind
    for row in CHECKS:
        if not row.models and kind in row.tolerances:
            yield Item(row.key, TWINS, host, library)
    for subject in subjects(library):
        for row in CHECKS:
            if applies(row, subject, kind, host):
                yield Item(row.key, subject.title, host, library)
        if probe is PairProbe:
            yield Item(CURVE, subject.title, host, library)
    if host_row(host).surfaces:
        for subject in SURFACES:
            for row in CHECKS:
                known = library if library in LIBRARIES else "eonlib"
                if known in subject.libraries and applies(row, subject, SurfaceProbe.kind, host):
                    yield Item(row.key, subject.title, host, library)
    if host_row(host).scenes:
        yield from (Item(PICTURE, str(file), host, library) for file in files)


def _native(host):
    """Items of a renderer's own nodes, which no library of ours plays a part in."""
    if probe_type(host) is NativeProbe:
        for subject in NATIVE:
            for row in CHECKS:
                if applies(row, subject, NativeProbe.kind, host):
                    yield Item(row.key, subject.title, host, "its own nodes")


def _software():
    """Versions of what takes part, asked of the modules: a build of one's own has no metadata."""
    return {
        "Python": platform.python_version(),
        "MaterialX": mx.getVersionString(),
        "numpy": np.__version__,
        "OpenImageIO": oiio.__version__,
        "moderngl": moderngl.__version__,
    }


def _examples(library):
    """The bundled documents, but for those with a node that the library lacks."""
    files = sorted(examples_folder().glob("*.mtlx"))
    lacking = [subject.node for subject in SUBJECTS if subject not in subjects(library)]
    return [file for file in files if not any(node in file.read_text() for node in lacking)]


def _options(policy):
    """Policy by the options of the command that change them."""
    prefixes = dict.fromkeys(LIMITS, "max") | {"outside": "allow", "code": "allow"}
    values = vars(policy) | {"path": os.pathsep.join(policy.path) or "none"}
    return {
        f"--{prefixes[name]}{name.capitalize()}" if name in prefixes else f"--{name}": str(value)
        for name, value in values.items()
    }


def _known(rule, names, known):
    for name in names:
        if name not in known:
            raise InputError(f"{rule} must be one of {', '.join(known)}; got {name!r}")
