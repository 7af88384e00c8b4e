// SPDX-License-Identifier: Apache-2.0
// The viewer of each shape, and the mapping between lights and points of the picture.
//
// World frame: x to the right, y up, z towards the viewer. The viewer's frame is the world rotated
// about x. The gl host sees a single sphere straight on and without perspective, as does the stage.

import type { Triple, Vec3 } from "../data";
import type { Shape, State } from "../state";

type Viewed = Pick<State, "shape" | "turn" | "tilt" | "zoom" | "comparison">;

export interface Camera {
  readonly axes: readonly [Vec3, Vec3, Vec3]; // right, up and back, in the world frame
  readonly eye: Vec3; // position in the world frame
  readonly distance: number; // distance of the eye from the target
  readonly span: number; // half of the frame's smaller side, relative to the subject's radius
}

interface View {
  readonly pitch: number; // degrees by which the viewer looks down
  readonly distance: number; // distance of the eye from the target
  readonly target: number; // height of the target
  readonly span: number;
}

const SIDE_SPAN = 1.5; // leaves room for two shapes in a picture with aspect ratio 4:3
const FAR = 1e8; // far enough that normalize(eye - position) is the z axis in float32

const VIEWS: Record<Shape, View> = {
  sphere: { pitch: 0, distance: FAR, target: 0, span: 1.14 },
  plane: { pitch: 18, distance: 8, target: -0.12, span: 1.5 },
  cloth: { pitch: 0, distance: 7, target: 0, span: 1.3 },
  ball: { pitch: 15, distance: 8, target: -0.12, span: 1.36 },
  fiber: { pitch: 0, distance: 8, target: 0, span: 1.1 },
};

/** Index of a shape in shapes.glsl. */
export const SHAPE_INDEX: Record<Shape, number> = {
  sphere: 0,
  plane: 1,
  cloth: 2,
  ball: 3,
  fiber: 4,
};

const BEND = -1.9; // height of the center around which the fibers bend: STAGE_BEND of shapes.glsl

/** The uniform stage_bend: height of the bend's center and 1 for fibers, zeros for other shapes. */
export function bend(shape: Shape): [number, number] {
  return shape === "fiber" ? [BEND, 1] : [0, 0];
}

/** Whether light may reach a point from behind the surface, so that the point has no shadow. */
export function isUnshadowed(shape: Shape): boolean {
  return shape === "sphere" || shape === "fiber";
}

/** The viewer of a state. Side by side, shapes are reduced to fit half of the width. */
export function camera({ shape, turn, tilt, zoom, comparison }: Viewed): Camera {
  const { pitch, distance, target, span } = VIEWS[shape];
  const part = span * (comparison === "side" ? SIDE_SPAN : 1);
  if (shape === "sphere") [turn, tilt, zoom] = [0, 0, 1]; // as on the gl host
  const [up, around] = [((pitch + tilt) * Math.PI) / 180, (turn * Math.PI) / 180];
  const [sine, cosine, S, C] = [Math.sin(up), Math.cos(up), Math.sin(around), Math.cos(around)];
  const back: Vec3 = [S * cosine, sine, C * cosine];
  const eye: Vec3 = [distance * back[0], target + distance * back[1], distance * back[2]];
  const axes = [[C, 0, -S], [-S * sine, cosine, -C * sine], back] as const;
  return { axes, eye, distance, span: part / zoom };
}

/** Convert a direction from the world frame to the viewer's frame. */
export function toView({ axes }: Camera, world: Vec3): Triple {
  return [dot(axes[0], world), dot(axes[1], world), dot(axes[2], world)];
}

/** Convert a direction from the viewer's frame to the world frame. */
function toWorld({ axes }: Camera, view: Vec3): Triple {
  const along = (k: 0 | 1 | 2) =>
    axes[0][k] * view[0] + axes[1][k] * view[1] + axes[2][k] * view[2];
  return [along(0), along(1), along(2)];
}

/** Convert a position in the frame to a side's picture; side by side, the frame shows both. */
export function fromSide({ comparison }: Viewed, x: number): number {
  return comparison === "side" ? x + (x < 0.5 ? 0.25 : -0.25) : x;
}

/** Convert a position in a side's picture to the frame; side by side, to its left half. */
export function toSide({ comparison }: Viewed, x: number): number {
  return comparison === "side" ? x - 0.25 : x;
}

/** Unit vector towards the light, in the world frame. */
export function lightVector({ azimuth, elevation }: Pick<State, "azimuth" | "elevation">): Triple {
  const [around, up] = [(azimuth * Math.PI) / 180, (elevation * Math.PI) / 180];
  return [Math.sin(around) * Math.cos(up), Math.sin(up), Math.cos(around) * Math.cos(up)];
}

/**
 * The light for a point of the picture, [0, 1]^2 from the top left. A point in the middle means a
 * light from the viewer, a point at the subject's rim means a light from the side, and a point at
 * twice the distance of the rim means a light from behind.
 */
export function lightAt(state: State, x: number, y: number, aspect: number) {
  const view = camera(state);
  const [right, up] = [(2 * x - 1) * Math.max(aspect, 1), (1 - 2 * y) * Math.max(1 / aspect, 1)];
  const distance = Math.hypot(right, up);
  const polar = (Math.min(distance * view.span, 2) * Math.PI) / 2;
  const side = distance > 0 ? Math.sin(polar) / distance : 0;
  const [wx, wy, wz] = toWorld(view, [right * side, up * side, Math.cos(polar)]);
  const degrees = 180 / Math.PI;
  return {
    azimuth: tenth(Math.atan2(wx, wz) * degrees),
    elevation: tenth(Math.asin(Math.max(-1, Math.min(1, wy))) * degrees),
  };
}

function tenth(degrees: number): number {
  return Math.round(10 * degrees) / 10;
}

/** The point of the picture for a light, which is the inverse of `lightAt`. */
export function lightMark(state: State, aspect: number): [number, number] {
  const view = camera(state);
  const [x, y, z] = toView(view, lightVector(state));
  const side = Math.hypot(x, y);
  const distance = (Math.atan2(side, z) * 2) / Math.PI / view.span;
  const scale = side > 0 ? distance / side : 0;
  return [
    0.5 + (0.5 * x * scale) / Math.max(aspect, 1),
    0.5 - (0.5 * y * scale) / Math.max(1 / aspect, 1),
  ];
}

export function dot(a: Vec3, b: Vec3): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

export function unit(v: Vec3): Triple {
  const length = Math.sqrt(dot(v, v));
  return [v[0] / length, v[1] / length, v[2] / length];
}

export function cross(a: Vec3, b: Vec3): Triple {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** Viewer and light in the frame of the normal, with the viewer in the x-z plane. */
export function localPair(normal: Triple, viewer: Triple, light: Triple): [Triple, Triple] {
  const mu = dot(viewer, normal);
  const [x, y, z] = viewer.map((each, k) => each - mu * (normal[k] ?? 0)) as Triple;
  const steep = Math.abs(normal[0]) < 0.5 ? ([1, 0, 0] as const) : ([0, 1, 0] as const);
  const along = Math.hypot(x, y, z) > 1e-9 ? unit([x, y, z]) : unit(cross(steep, normal));
  const beside = cross(normal, along);
  const local = (v: Triple): Triple => [dot(v, along), dot(v, beside), dot(v, normal)];
  return [unit(local(viewer)), unit(local(light))];
}
