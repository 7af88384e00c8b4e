# SPDX-License-Identifier: Apache-2.0
"""Survey of renderers' own materials: engines, nodes, checks, and a page that compares them.

`mxeon.hosts.RENDERERS` has a row for each renderer, whose module lists the judged nodes in `NODES`.
"""
