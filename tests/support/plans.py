# SPDX-License-Identifier: Apache-2.0
"""Short runs: some of the checks, for tests of what a run does with its results."""

from dataclasses import replace

from mxeon.conformance import run


def keep_checks(patch, *keys):
    """Let every run that this process plans consist of the checks with these keys alone."""
    whole = run.make_plan

    def make_plan(*arguments, **options):
        plan = whole(*arguments, **options)
        return replace(plan, tasks=tuple(task for task in plan.tasks if task.check in keys))

    patch.setattr(run, "make_plan", make_plan)
