# SPDX-License-Identifier: Apache-2.0
"""The models as a host: graphs of lobes and layers, and what they cannot say."""

import pytest

from mxeon.conformance.pictures import judge_document
from mxeon.conformance.reference import Host as Reference
from mxeon.errors import NotRun
from mxeon.hosts import open_host
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import EON
from mxeon.shaders.scene import FRONT, Scene
from tests.support.documents import lobe, material

A = f'<{EON} name="a" type="BSDF"><input name="color" type="color3" value="0.8, 0.4, 0.1"/></{EON}>'
OUTSIDE = (
    ({"color": "0.5, 1.5, 0.5"}, "color must lie in [0, 1]; got 1.5"),
    ({"weight": "1.5"}, "weight must lie in [0, 1]; got 1.5"),
    ({"roughness": "1.6"}, "roughness must lie in [0, pi/2]; got 1.6"),
)


@pytest.mark.parametrize(
    "nodes, scene, words",
    [
        (
            f"""<noise2d name="bump" type="vector3"/><{EON} name="lobe" type="BSDF">
            <input name="normal" type="vector3" nodename="bump"/></{EON}>""",
            FRONT,
            "no model for node 'noise2d'",
        ),
        (
            f"""<{EON} name="lobe" type="BSDF"><input name="color" type="color3"
            value="0.5, 0.5, 0.5" colorspace="acescg"/></{EON}>""",
            FRONT,
            "no transform from color space acescg to lin_rec709",
        ),
        (A.replace('"a"', '"lobe"'), Scene("sky", environment="sky.exr"), "must be uniform"),
    ],
    ids=["noise", "color space", "image of an environment"],
)
def test_what_the_models_do_not_cover_did_not_run(nodes, scene, words):
    managed = material(nodes).replace("<materialx ", '<materialx colorspace="lin_rec709" ')
    shader = generate(managed, "glsl")[0]
    with pytest.raises(NotRun, match=words):
        Reference().picture(shader, scene)


@pytest.mark.parametrize("inputs, rule", OUTSIDE, ids=str)
def test_a_value_outside_its_model_is_not_judged(tmp_path, inputs, rule):
    path = tmp_path / "look.mtlx"
    path.write_text(material(lobe(**inputs)))
    hosts = open_host("gl"), Reference()
    [result], pictures, notes = judge_document(path, *hosts, "eonlib")
    assert result.verdict == "not run" and not pictures
    assert f"reference: node 'lobe': {rule}" in result.reason
    assert "where its model is defined" in notes[0][0]
