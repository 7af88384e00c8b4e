# SPDX-License-Identifier: Apache-2.0
"""Checks of the utility nodes of pbrlib, which compute numbers and colors that feed the lobes."""
