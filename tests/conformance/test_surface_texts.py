# SPDX-License-Identifier: Apache-2.0
"""Graphs of surface shaders compute what the specification states, apart from known deviations."""

from functools import cache
from pathlib import Path

import MaterialX as mx
import numpy as np
import pytest

from mxeon.conformance.reference.graph import Graph
from mxeon.conformance.reference.nodes import ShadingPoints
from mxeon.conformance.samples import Counts
from mxeon.conformance.specs.surface_texts import EMITTED, SENTENCES, THROUGH, SentenceSpec
from mxeon.models.shading_model import ALONG, UP
from mxeon.shaders.generation import Shader, generate
from tests.support.verdicts import Verdicts, has
from tools.site.ledger import apply, linked, patches

pytestmark = pytest.mark.whole
SAME = 1e-4  # the tolerance allows for rounded constants in the graphs
INPUTS = sorted({(spec.text.node, port.name) for spec in SENTENCES for port in spec.inputs})


@cache
def shader(node: str, library: str = "stock") -> Shader:
    """Generated shader of a material that consists of one surface shader node."""
    [spec, *_] = (each for each in SENTENCES if each.text.node == node)
    [made] = generate(spec.document(), "glsl", library=library)
    return made


def shown(spec: SentenceSpec, library: str = "stock") -> np.ndarray:
    """Values of a surface shader's graph at the samples for one sentence of the specification."""
    [batch] = spec.batches(Counts())
    branch, _, factor = spec.evaluated
    count, made = len(batch.wo), shader(spec.text.node, library)
    inputs = {**spec.fixed, **batch.inputs}
    for name, value in inputs.items():
        if np.shape(value)[:1] != (count,):
            inputs[name] = np.broadcast_to(value, (count, *np.shape(value)[-1:]))
    dark = np.broadcast_to([0.0, 0.0, -1.0], batch.wo.shape)
    wi = {"direct": batch.wi, "emission": dark}.get(branch)
    frame = (np.broadcast_to(axis, batch.wo.shape) for axis in (UP, ALONG))
    behind = spec.evaluated == THROUGH
    points = ShadingPoints(batch.wo, wi, 1.0, *frame, behind=behind)
    graph = Graph(made.document, points, inputs, emits=spec.evaluated == EMITTED)
    return np.broadcast_to(factor * graph.element(made.element), batch.wo.shape)


def distances(spec: SentenceSpec, values: np.ndarray) -> list[float]:
    """Largest differences of `values` from the specified formula, and from each known deviation."""
    [batch] = spec.batches(Counts())
    forms = spec.value_candidates[:-1]  # the last candidate is black
    return [float(np.abs(form.values(batch) - values).max()) for form in forms]


@pytest.mark.parametrize("spec", SENTENCES)
def test_each_difference_from_a_text_has_a_name(spec):
    own, *others = distances(spec, shown(spec))
    if own <= SAME:
        assert min(others, default=np.inf) > SAME  # no known deviation equals the specified formula
    else:
        assert min(others) <= SAME


@pytest.fixture(scope="module")
def repaired(tmp_path_factory: pytest.TempPathFactory) -> str:
    package = linked(Path(mx.__file__).parent, tmp_path_factory.mktemp("repaired") / "MaterialX")
    graphs = [path for path in patches("materialx").values() if "/bxdf/" in path.read_text()]
    return str(apply(package, *graphs) / "libraries")


@pytest.mark.parametrize("spec", SENTENCES)
def test_patched_graphs_do_what_their_texts_say(spec: SentenceSpec, repaired: str):
    """Patched graphs compute the specified formula, or a formula that the specification permits."""
    [batch] = spec.batches(Counts())
    own, *others = spec.value_candidates
    forms = [each for each in others if each.permitted]
    values = shown(spec, repaired)
    assert min(np.abs(form.values(batch) - values).max() for form in (own, *forms)) <= SAME


@pytest.mark.parametrize("title", ["Standard Surface, sheen", "glTF, transmission"])
def test_a_diagnosis_tells_a_graph_from_its_lobes(judged: Verdicts, title: str):
    """Stock MaterialX has a wrong graph and wrong lobes. With eonlib, only the graph is wrong."""
    assert has(judged("specification", title, library="stock"), "lobes_of_graph")
    assert not has(judged("specification", title), "lobes_of_graph")


@pytest.mark.parametrize(("node", "name"), INPUTS, ids=" ".join)
def test_wrong_graphs_are_seen(node, name):
    made = shader(node)
    graph = made.document.getNode("shading").getImplementation()
    specs = [spec for spec in SENTENCES if spec.text.node == node]
    specs = [spec for spec in specs if name in {port.name for port in spec.inputs}]
    default = graph.getNodeDef().getActiveInput(name)
    readers = [port for each in graph.getNodes() for port in each.getInputs()]
    readers = [port for port in readers if port.getInterfaceName() == name]
    assert readers
    scaled = default.getType() in ("float", "color3")
    for change in ("dropped", "twice") if scaled else ("dropped",):
        for port in readers:
            port.removeAttribute("interfacename")
            if change == "dropped":
                port.setValueString(default.getValueString())
        if change == "twice":
            square = graph.addNode("multiply", "squared_input", default.getType())
            for each in ("in1", "in2"):
                square.addInput(each, default.getType()).setInterfaceName(name)
            for port in readers:
                port.setNodeName(square.getName())
        try:
            seen = any(min(distances(spec, shown(spec))) > SAME for spec in specs)
        finally:
            for port in readers:
                port.removeAttribute("nodename")
                port.removeAttribute("value")
                port.setInterfaceName(name)
            if change == "twice":
                graph.removeNode("squared_input")
        assert seen, f"{name} {change}"
