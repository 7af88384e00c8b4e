# SPDX-License-Identifier: Apache-2.0
"""MaterialX documents, data libraries and generated shaders, without mxeon's shading models."""
