# SPDX-License-Identifier: Apache-2.0
"""OSL's own programs as a host (`renderer`), and the scene (`scenes`), which needs none of them."""
