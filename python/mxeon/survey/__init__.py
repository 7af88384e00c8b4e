# SPDX-License-Identifier: Apache-2.0
"""Renderers with their own materials: their engines, nodes and checks, and the page that compares them.

`mxeon.hosts.RENDERERS` has a row for each. The `NODES` of its module are judged.
"""
