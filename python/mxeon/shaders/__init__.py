# SPDX-License-Identifier: Apache-2.0
"""MaterialX documents, data libraries and generated shaders. No module here imports the models."""
