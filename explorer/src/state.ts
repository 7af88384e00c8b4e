// SPDX-License-Identifier: Apache-2.0
// The view as plain data: everything that the picture depends on, and its address.

import type { Triple } from "./data";

export const SHAPES = ["sphere", "plane", "cloth", "ball", "fiber"] as const; // plane: a sphere on it
export const SURROUNDINGS = ["none", "uniform", "studio", "sky", "window", "own"] as const;
export const COMPARISONS = ["wipe", "side", "difference", "flicker"] as const;
export const SAMPLERS = ["exact", "cltc", "cosine"] as const;

export const ZOOMS = [0.25, 8] as const;

export type Shape = (typeof SHAPES)[number];
export type Surroundings = (typeof SURROUNDINGS)[number];
export type Comparison = (typeof COMPARISONS)[number];
export type Sampler = (typeof SAMPLERS)[number];
export type SideName = "left" | "right";

/** One of the two materials that are compared. */
export interface Side {
  readonly source: string; // id of a Source
  readonly flag: boolean; // energy_compensation, where the source has it
  readonly sampler: Sampler; // of path tracing
}

export interface State {
  readonly left: Side;
  readonly right: Side;
  readonly comparison: Comparison;
  readonly wipe: number; // share of the width that shows the left material, in [0, 1]
  readonly scale: number; // difference that has the full color, in units of the picture's radiance
  readonly shown: SideName; // by flicker
  readonly shape: Shape;
  /** Where the viewer is, in degrees from a shape's own place: around it, and up. Not for the sphere. */
  readonly turn: number; // [-180, 180]
  readonly tilt: number; // [-90, 90]
  readonly zoom: number; // size of the shape over its own, [0.25, 8]
  /** Direction to the light: degrees around the upright axis from the viewer, positive to the right. */
  readonly azimuth: number; // [-180, 180]
  readonly elevation: number; // degrees above the horizon, [-90, 90]
  readonly light: number; // irradiance over pi of a surface that faces the light; 0 switches it off
  readonly surroundings: Surroundings;
  readonly exposure: number; // stops
  readonly color: Readonly<Triple>; // rho, linear, each in [0, 1]
  readonly roughness: number; // r, or sigma in radian; in [0, 1]
  readonly wanted: Readonly<Triple>; // albedo that the color is asked for
  readonly average: boolean; // whether it is the average albedo, not that at normal incidence
  readonly keep: boolean; // whether `color` follows from `wanted`
  readonly paths: boolean; // path tracing instead of the generated shader's own lighting
  readonly samples: number; // per pixel, at which path tracing stops
  /** Values of a document's inputs that differ from its own, by source id and name of the uniform. */
  readonly inputs: Readonly<Record<string, Readonly<Record<string, Value>>>>;
  /** Where the probe is, in the picture: [0, 1]^2 from the left top; null for none. */
  readonly probe: readonly [number, number] | null;
}

export type Value = number | boolean | readonly number[];

export const INITIAL: State = {
  left: { source: "shader/eonlib", flag: true, sampler: "exact" },
  right: { source: "shader/stock", flag: true, sampler: "exact" },
  comparison: "wipe",
  wipe: 0.5,
  scale: 0.1,
  shown: "left",
  shape: "ball",
  turn: 0,
  tilt: 0,
  zoom: 1,
  azimuth: 155, // from behind and above: where implementations part
  elevation: 35,
  light: 1.5,
  surroundings: "studio",
  exposure: 0,
  color: [0.8, 0.4, 0.1],
  roughness: 1,
  wanted: [0.8, 0.4, 0.1],
  average: false,
  keep: false,
  paths: false,
  samples: 256,
  inputs: {},
  probe: null,
};
