# SPDX-License-Identifier: Apache-2.0
"""Work in other processes and on other machines. Knows nothing of shading."""
