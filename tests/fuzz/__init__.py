# SPDX-License-Identifier: Apache-2.0
"""What `mxeon` must never do, whatever documents, command lines and files it is given."""
