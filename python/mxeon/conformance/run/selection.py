# SPDX-License-Identifier: Apache-2.0
"""The tasks of a run that are asked for: by nodes, by the documents' nodes, or for an audit."""

from collections.abc import Callable, Iterable, Sequence

from mxeon.conformance.probes.families import ALL_SUBJECTS, COMMON_SUBJECTS, PBR_SUBJECTS
from mxeon.conformance.run.survey import Survey
from mxeon.conformance.run.tasks import DOCUMENT, Task
from mxeon.errors import InputError, assert_known
from mxeon.hosts import host_names, host_row
from mxeon.shaders.versions import check_version

ALL, COMMON = "all", "common"  # in place of the nodes' names


def assert_known_names(hosts: Iterable[str], nodes: Iterable[str]) -> None:
    """Raise InputError for an unknown host or node, and ImportError if MaterialX is too old."""
    check_version()
    for name in hosts:
        assert_known("host", name, host_names())
    for name in nodes:
        assert_known("node", name, (*node_names(), COMMON, ALL))


def node_names() -> tuple[str, ...]:
    """Categories of the nodes that are judged."""
    return tuple(dict.fromkeys(row.node for row in ALL_SUBJECTS))


def selected(
    tasks: Sequence[Task],
    files: Sequence[str],
    nodes: Sequence[str],
    survey: Survey,
    elsewhere: Callable[[], str] = str,
) -> list[Task]:
    """The tasks that are asked for, those of the user's documents first.

    Raise InputError if none of the nodes is judged.
    """
    titles = {row.title for row in ALL_SUBJECTS if row.node in nodes}
    rare = {each.title for each in PBR_SUBJECTS} - {each.title for each in COMMON_SUBJECTS}
    audit = COMMON in nodes or not (nodes or files)
    if not nodes:
        titles = {title for file in files for title in survey.nodes.get(file, ())}
    chosen = [
        task
        for task in tasks
        if ALL in nodes
        or task.subject in files
        or task.subject in titles
        or (audit and task.subject not in rare)
    ]
    if nodes and not chosen:
        hosts = ", ".join(dict.fromkeys(task.host for task in tasks if task.host != "source"))
        raise InputError(
            f"node must be judged on one of the hosts {hosts}; got {', '.join(nodes)}{elsewhere()}"
        )
    return sorted(chosen, key=lambda task: task.subject not in files)


def unmeasured(tasks: Sequence[Task], hosts: Iterable[str]) -> list[str]:
    """Hosts on which tasks would measure nothing, and none says so.

    The task of a document says so on a host that reads none.
    """
    telling = {
        task.host for task in tasks if task.check != DOCUMENT or not host_row(task.host).target
    }
    return [host for host in hosts if tasks and host not in telling]
