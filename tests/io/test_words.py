# SPDX-License-Identifier: Apache-2.0
"""The error output of libraries in other languages."""

import os

from mxeon.shaders.generation import generate
from mxeon.shaders.generators import ERROR, lines_left_out
from mxeon.shaders.nodes import SURFACE, document_text


def test_lines_with_the_words_are_left_out_and_others_are_not(capfd):
    with lines_left_out("of no use"):
        os.write(ERROR, b"this is of no use\nthis is\n")
    assert capfd.readouterr().err == "this is\n"


def test_generated_wgsl_says_nothing_of_booleans(capfd):
    lobe = '<oren_nayar_diffuse_bsdf name="lobe" type="BSDF"/>'  # whose flag is a boolean
    generate(document_text(lobe + SURFACE), "wgsl")
    assert capfd.readouterr().err == ""
