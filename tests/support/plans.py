# SPDX-License-Identifier: Apache-2.0
"""Restricts runs to a few checks, for tests that only process results."""

from dataclasses import replace

from mxeon.conformance import run
from mxeon.conformance.run.plan import node_names
from mxeon.shaders.nodes import EON, OREN_NAYAR


def keep_checks(patch, *keys):
    """Restrict the runs of this process to the given checks of diffuse nodes."""
    others = {*node_names()} - {EON, OREN_NAYAR}
    keep(patch, lambda task: task.check in keys and task.subject.split(",")[0] not in others)


def keep(patch, kept):
    whole = run.make_plan

    def make_plan(*arguments, **options):
        plan = whole(*arguments, **options)
        return replace(plan, tasks=tuple(filter(kept, plan.tasks)))

    patch.setattr(run, "make_plan", make_plan)
