# SPDX-License-Identifier: Apache-2.0
"""The polyhedron: flat and convex, and every judged pixel lies within one facet."""

import numpy as np

from mxeon.survey.facets import NARROWEST, facet_points, polyhedron

ROUNDING = 2.0**-24  # of the vertices


def test_it_is_closed_and_its_triangles_face_outwards():
    vertices, triangles, _, _ = polyhedron()
    corners = vertices[triangles]
    volume = np.linalg.det(corners).sum() / 6.0
    edges = {tuple(each) for each in triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)}
    assert {(b, a) for a, b in edges} == edges
    assert 0.97 * 4.0 / 3.0 * np.pi < volume < 4.0 / 3.0 * np.pi


def test_it_is_convex_and_its_facets_are_flat():
    vertices, triangles, normals, offsets = polyhedron()
    assert (vertices @ normals.T - offsets).max() <= 2.0 * ROUNDING
    corners = vertices[triangles]
    own = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    own /= np.linalg.norm(own, axis=1, keepdims=True)
    sine = np.linalg.norm(np.cross(own[:, np.newaxis], normals[np.newaxis]), axis=-1).min(axis=1)
    assert sine.max() <= 2.0 * np.sqrt(3.0) * ROUNDING / NARROWEST


def test_a_judged_pixel_sees_one_facet_wherever_a_ray_meets_it():
    size, (_, _, normals, offsets) = 64, polyhedron()
    points, rng = facet_points(size), np.random.default_rng(1)
    rows, columns = np.nonzero(points.mask)
    shift = rng.random((2, 8, len(rows)))
    x = (2.0 * (columns + shift[0])) / size - 1.0
    y = 1.0 - 2.0 * (rows + shift[1]) / size
    front = normals[:, 2] > 0.0
    height = (offsets - np.stack([x, y], axis=-1) @ normals[:, :2].T) / normals[:, 2]
    first = np.where(front, height, np.inf).argmin(axis=-1)
    np.testing.assert_array_equal(
        normals[first], np.broadcast_to(points.normal[points.mask], (*first.shape, 3))
    )
    assert len(rows) > 500


def test_its_facets_differ_in_both_cosines():
    points = facet_points(128)
    normals = np.unique(points.normal[points.mask], axis=0)
    assert len(normals) > 250
    assert normals[:, 2].min() < 0.15 and normals[:, 2].max() > 0.98
