// SPDX-License-Identifier: Apache-2.0
// The view as plain data: all inputs of the picture, which the address stores.

import type { Triple } from "./data";

// "plane" is a sphere on a plane.
export const SHAPES = ["sphere", "plane", "cloth", "ball", "fiber"] as const;
export const SURROUNDINGS = ["none", "uniform", "studio", "sky", "own"] as const;
export const COMPARISONS = ["wipe", "side", "difference", "flicker"] as const;
export const SAMPLERS = ["exact", "cltc", "cosine"] as const;

export const ZOOMS = [0.25, 8] as const;

export type Shape = (typeof SHAPES)[number];
export type Surroundings = (typeof SURROUNDINGS)[number];
export type Comparison = (typeof COMPARISONS)[number];
export type Sampler = (typeof SAMPLERS)[number];
export type SideName = "left" | "right";

/** One of the two materials to compare. */
export interface Side {
  readonly source: string; // id of a Source
  readonly flag: boolean; // energy_compensation, if the source has this input
  readonly sampler: Sampler; // how path tracing samples a model; see SAMPLERS in stage/texts.ts
}

export interface State {
  readonly left: Side;
  readonly right: Side;
  readonly comparison: Comparison;
  readonly wipe: number; // fraction of the width that shows the left material, in [0, 1]
  readonly scale: number; // difference at the end of the color scale, as radiance of the picture
  readonly shown: SideName; // the side that the comparison "flicker" shows
  readonly shape: Shape;
  /**
   * The viewer's direction relative to the shape's default, in degrees. `turn` is around the shape
   * and `tilt` is up. The sphere ignores both angles.
   */
  readonly turn: number; // [-180, 180]
  readonly tilt: number; // [-90, 90]
  readonly zoom: number; // magnification of the shape, [0.25, 8]
  /**
   * Direction to the light: degrees around the vertical axis from the viewer, positive to the
   * right.
   */
  readonly azimuth: number; // [-180, 180]
  readonly elevation: number; // degrees above the horizon, [-90, 90]
  readonly light: number; // irradiance / pi of a surface facing the light; 0 switches the light off
  readonly surroundings: Surroundings;
  readonly exposure: number; // in stops
  readonly color: Readonly<Triple>; // rho, linear, each in [0, 1]
  readonly roughness: number; // r, or sigma in radians, in [0, 1]
  readonly wanted: Readonly<Triple>; // requested albedo, from which the color follows
  // Whether `wanted` is the average albedo instead of the albedo at normal incidence.
  readonly average: boolean;
  readonly keep: boolean; // whether `color` follows from `wanted`
  readonly paths: boolean; // whether paths are traced instead of using the shader's own lighting
  readonly samples: number; // paths per pixel at which path tracing stops
  /** Input values that differ from the document's own, by source id and uniform name. */
  readonly inputs: Readonly<Record<string, Readonly<Record<string, Value>>>>;
  /** Position of the probe in the picture: [0, 1]^2 from the top left; null without a probe. */
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
  azimuth: 155, // from behind and above, where implementations differ
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
