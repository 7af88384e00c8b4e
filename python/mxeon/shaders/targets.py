# SPDX-License-Identifier: Apache-2.0
"""Targets of shader generation. Importing this module does not import MaterialX."""

# MaterialX's module and class for each target. Slang needs MaterialX 1.39.5, and WGSL needs 1.39.4.
CLASSES = {
    "glsl": ("GenGlsl", "GlslShaderGenerator"),
    "essl": ("GenGlsl", "EsslShaderGenerator"),
    "vulkan": ("GenGlsl", "VkShaderGenerator"),
    "wgsl": ("GenGlsl", "WgslShaderGenerator"),
    "msl": ("GenMsl", "MslShaderGenerator"),
    "slang": ("GenSlang", "SlangShaderGenerator"),
    "osl": ("GenOsl", "OslShaderGenerator"),
    "mdl": ("GenMdl", "MdlShaderGenerator"),
}
PATH_TRACED = ("glsl", "essl", "vulkan", "slang")  # targets of the profile "path"
