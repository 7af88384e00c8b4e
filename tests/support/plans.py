# SPDX-License-Identifier: Apache-2.0
"""Short runs: some of the checks, for tests of what a run does with its results."""

from dataclasses import replace

from mxeon.conformance import run
from mxeon.conformance.run.plan import node_names
from mxeon.shaders.nodes import EON, OREN_NAYAR


def keep_checks(patch, *keys):
    """Let every run that this process plans consist of these checks of diffuse nodes alone."""
    others = {*node_names()} - {EON, OREN_NAYAR}
    keep(patch, lambda task: task.check in keys and task.subject.split(",")[0] not in others)


def keep_host(patch, host):
    """Let every run that this process plans consist of what a host is asked, without texts."""
    keep(patch, lambda task: task.host == host)


def keep(patch, kept):
    """Let plans have the tasks that are kept alone."""
    whole = run.make_plan

    def make_plan(*arguments, **options):
        plan = whole(*arguments, **options)
        return replace(plan, tasks=tuple(filter(kept, plan.tasks)))

    patch.setattr(run, "make_plan", make_plan)
