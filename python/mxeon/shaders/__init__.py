# SPDX-License-Identifier: Apache-2.0
"""MaterialX documents, generated shaders, and the hosts that run them. Never imports the models."""
