# SPDX-License-Identifier: Apache-2.0
"""Checks of a lobe: its values and albedos, its frame, its inputs and its edges."""

from mxeon.conformance.accuracy import bsdf as bsdf_tolerances
from mxeon.conformance.accuracy import diffuse as tolerances
from mxeon.conformance.accuracy.engine import widen_for_engine
from mxeon.conformance.checks import measures, sampling_measures
from mxeon.conformance.checks.check import Check
from mxeon.conformance.checks.controls import (
    drop_changes,
    gray,
    offset,
    scale_cosine,
    take_other_mode,
    take_response,
    with_inputs,
)
from mxeon.conformance.checks.names import (
    COMBINATION,
    EMITTER,
    FRAMED,
    MEDIUM_NAMES,
    OTHERS,
    shows_exactly,
)
from mxeon.conformance.diagnosis import inputs as input_diagnosis
from mxeon.conformance.diagnosis.candidates import Diagnosis, explain
from mxeon.conformance.diagnosis.comparisons import ALBEDO, VALUE
from mxeon.conformance.nodes.bsdf import BSDFS
from mxeon.conformance.nodes.diffuse import DiffuseLobe, DiffuseSubject
from mxeon.conformance.nodes.hair import HAIRS
from mxeon.conformance.nodes.renderer_nodes import RendererNode
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.nodes.subsurface import SUBSURFACES
from mxeon.conformance.probes.cases import (
    dead_inputs,
    frame_cases,
    surroundings_case,
)
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.probes.subsurface import ON_SPHERES, sphere_cases
from mxeon.hosts import front_lit_only
from mxeon.models.nodes import NODES
from mxeon.models.nodes.hair import HAIR_NODE
from mxeon.models.nodes.lobes import LOBE_NODES
from mxeon.models.nodes.subsurface import SUBSURFACE_NODE
from mxeon.shaders.nodes import FLAG

EON = ("eon", "eon_fitted")
ANY = (*EON, "qon")
LAYERLESS = (
    *(row.name for row in NODES if not row.layerable),
    HAIR_NODE.name,
    SUBSURFACE_NODE.name,
)
BLACKENED = tuple(subject.model for subject in (*BSDFS, *HAIRS, *SUBSURFACES) if subject.black)
# Nodes that look an environment up at a normal, beside the rough diffuse ones.
LOOKED_UP = (*(row.name for row in LOBE_NODES), HAIR_NODE.name, SUBSURFACE_NODE.name)
RECIPROCAL = tuple(row.name for row in NODES if row.reciprocal)
SMOOTH = ("lambert",)
ROUGH = (*ANY, "fon")
COATED = ("eon_coated", "openpbr_half_metal")  # which a renderer has


def diagnose_sphere(probe: Probe) -> Diagnosis:
    """The explanation of light on a sphere."""
    cases = list(sphere_cases(probe))
    return explain(probe, cases, ON_SPHERES, (), bsdf_tolerances.RINGS)


def has_flag(subject: Subject, host: str) -> bool:
    """Whether a node has the flag that switches the model."""
    return isinstance(subject, DiffuseSubject) and FLAG in subject.inputs


def is_lobe(subject: Subject, host: str) -> bool:
    """Whether a subject is the lobe of a surface shader, or a renderer's own Lambert."""
    return isinstance(subject, DiffuseLobe) or subject.model == "lambert"


def is_node(subject: Subject, host: str) -> bool:
    """Whether a subject is a node, and not the lobe of a surface shader."""
    return not isinstance(subject, DiffuseLobe)


def is_alone(subject: Subject, host: str) -> bool:
    """Whether no other lobe lies beside the diffuse one."""
    others = isinstance(subject, RendererNode) and subject.others
    return is_node(subject, host) and not others


def is_sampled(subject: Subject, host: str) -> bool:
    """Whether a renderer's own sampling of the subject can be called."""
    return isinstance(subject, RendererNode) and subject.sampled


def has_environment(subject: Subject, host: str) -> bool:
    """Whether a host has the subject's model for all pairs, as an environment needs."""
    return not front_lit_only(host, subject.model)


CHECKS = (
    Check(
        "value",
        "The value matches the model for every pair of directions, including back-lit and grazing ones.",
        (*ROUGH, *OTHERS, *COATED),
        VALUE,
        gray,
        applies=is_node,
        open=True,
        adapt=widen_for_engine,
    ),
    Check(
        "lobe",
        "The diffuse lobe of the surface shader matches the model.",
        (*ANY, *SMOOTH),
        VALUE,
        gray,
        applies=is_lobe,
    ),
    Check(
        "environment",
        "The environment branch returns the directional albedo.",
        (*ROUGH, *OTHERS, *SMOOTH, *COATED),
        ALBEDO,
        gray,
        applies=has_environment,
        open=True,
    ),
    Check(
        "albedo",
        "Values integrate to the colored directional albedo.",
        ANY,
        measures.quadrature,
        gray,
        "integral",
    ),
    Check(
        "furnace",
        "A white surface disappears in a white environment.",
        (*EON, *COATED),
        measures.furnace,
        with_inputs("reflectance is 0.99", color=(0.99, 0.99, 0.99)),
        "albedo",
        applies=has_environment,
        diagnose=ALBEDO.diagnose,
    ),
    Check(
        "black",
        "A black surface scatters nothing.",
        (*ROUGH, *BLACKENED, *SMOOTH),
        measures.black,
        offset,
        tolerances.ZERO,
        applies=is_alone,
    ),
    Check(
        "density",
        "The sampling density is the paper's.",
        EON,
        sampling_measures.density,
        with_inputs("roughness is dropped", roughness=0.0),
        tolerances.OWN_DENSITY,
        applies=is_sampled,
        diagnose=lambda probe: Diagnosis("the density differs from the paper's listings"),
    ),
    Check(
        "samples",
        "Samples follow the density that is returned with them.",
        EON,
        sampling_measures.samples,
        with_inputs("the density is that of roughness 0", roughness=0.0),
        tolerances.CHI_SQUARE,
        applies=is_sampled,
        diagnose=lambda probe: Diagnosis("the samples do not follow the density"),
    ),
    Check(
        "frame",
        "The value follows the surface's frame, with the normal turned toward the viewer.",
        (*ANY, *FRAMED),
        frame_cases,
        with_inputs("the node's normal is dropped", normal=(0.0, 0.0, 1.0)),
        "frame",
        diagnose=input_diagnosis.diagnose_frame,
    ),
    Check(
        "surroundings",
        "An uneven environment is looked up along the viewer-facing normal, or along its opposite for translucent nodes.",
        (*ANY, *LOOKED_UP),
        surroundings_case,
        with_inputs("the node's normal is dropped", normal=(0.0, 0.0, 1.0)),
        tolerances.SURROUNDINGS,
        pairs=True,
        lit=True,
        diagnose=input_diagnosis.diagnose_surroundings,
    ),
    Check(
        "sphere",
        "On a sphere, light spreads as the diffusion profile predicts from radius and anisotropy.",
        (SUBSURFACE_NODE.name,),
        sphere_cases,
        with_inputs("the mean free path is 0.3 in every channel", radius=(0.3, 0.3, 0.3)),
        bsdf_tolerances.RINGS,
        lit=True,
        diagnose=diagnose_sphere,
    ),
    Check(
        "sphere_mean",
        "On average, a sphere reflects the share of light that the profile predicts.",
        (SUBSURFACE_NODE.name,),
        sphere_cases,
        with_inputs("the mean free path is 0.3 in every channel", radius=(0.3, 0.3, 0.3)),
        bsdf_tolerances.RINGS_MEAN,
        lit=True,
        diagnose=diagnose_sphere,
    ),
    Check(
        "throughput",
        "No light from below passes: the throughput is 0 in every branch, for every weight.",
        (*ANY, *LAYERLESS),
        measures.throughput,
        take_response,
        tolerances.OPAQUE,
        pairs=True,
        lit=True,
        diagnose=input_diagnosis.diagnose_throughput,
    ),
    Check(
        "reciprocity",
        "Exchanging the two directions does not change the BRDF.",
        (*ROUGH, *RECIPROCAL, *SMOOTH),
        measures.reciprocity,
        scale_cosine("the value has an extra factor cos(theta_o)", 1),
        "reciprocity",
    ),
    Check(
        "lambert",
        "At roughness 0 the node is Lambert.",
        ANY,
        measures.lambert,
        with_inputs("roughness is 0.1", roughness=0.1),
        "lambert",
    ),
    Check(
        "flag",
        "energy_compensation changes the value by the difference between the two models.",
        ANY,
        measures.flag,
        take_other_mode,
        "difference",
        applies=has_flag,
    ),
    Check(
        "inputs",
        "Every input of the node changes the value.",
        (*ROUGH, *OTHERS, *SMOOTH, *COATED, *COMBINATION, *EMITTER, *MEDIUM_NAMES),
        measures.counted(dead_inputs),
        drop_changes,
        tolerances.count_of("inputs"),
        applies=is_node,
        diagnose=input_diagnosis.diagnose_inputs,
    ),
    Check(
        "finite",
        "Every value at the edges of the domain is finite.",
        (*ANY, *OTHERS),
        measures.finite(),
        scale_cosine("the value is divided by cos(theta_o)", -1),
        tolerances.count_of("values"),
        pairs=True,
        applies=shows_exactly,
        diagnose=input_diagnosis.diagnose_finite,
    ),
)
