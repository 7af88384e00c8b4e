# SPDX-License-Identifier: Apache-2.0
"""Things that `mxeon` must never do, with any document, command line or file."""
