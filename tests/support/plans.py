# SPDX-License-Identifier: Apache-2.0
"""Short runs: some of the checks, for tests of what a run does with its results."""

from dataclasses import replace

from mxeon.conformance import run
from mxeon.conformance.probes.families import PBR_SUBJECTS


def keep_checks(patch, *keys):
    """Let every run that this process plans consist of these checks of diffuse nodes alone."""
    whole, others = run.make_plan, {subject.title for subject in PBR_SUBJECTS}

    def make_plan(*arguments, **options):
        plan = whole(*arguments, **options)
        tasks = (each for each in plan.tasks if each.check in keys and each.subject not in others)
        return replace(plan, tasks=tuple(tasks))

    patch.setattr(run, "make_plan", make_plan)
