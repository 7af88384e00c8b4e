# SPDX-License-Identifier: Apache-2.0
"""Record the picture of OSL's programs again."""

from tests.support.osl import record

record()
