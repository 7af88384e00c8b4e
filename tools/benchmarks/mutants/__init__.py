# SPDX-License-Identifier: Apache-2.0
"""Wrong libraries, one change each, and the checks that notice them."""
