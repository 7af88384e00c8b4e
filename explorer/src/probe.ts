// SPDX-License-Identifier: Apache-2.0
// The probe shows pairs of directions and float64 values of the models.

import type { Triple, Vec3 } from "./data";
import { piFCos, type Model } from "./models/table";
import { dot, lightVector, unit } from "./stage/scenes";
import type { State } from "./state";

const RADIAN = Math.PI / 180;

/** A pair of directions in the local frame of the normal (z); wo lies in the x-z plane. */
export interface Pair {
  readonly wo: Vec3;
  readonly wi: Vec3;
}

/** The pair for a normal, a viewer and a light, all unit vectors in one frame. */
function pairOf(normal: Vec3, viewer: Vec3, light: Vec3): Pair {
  const muO = Math.min(dot(normal, viewer), 1.0);
  const muI = Math.min(dot(normal, light), 1.0);
  const s = dot(viewer, light) - muO * muI;
  const S_o = Math.sqrt(1.0 - muO * muO);
  const x = S_o > 0.0 ? s / S_o : Math.sqrt(Math.max(0.0, 1.0 - muI * muI));
  const y = Math.sqrt(Math.max(0.0, 1.0 - muI * muI - x * x));
  return { wo: [S_o, 0.0, muO], wi: unit([x, y, muI]) };
}

/** A pair whose directions are unit vectors in float64. */
export function unitPair({ wo, wi }: Pair): Pair {
  return { wo: unit(wo), wi: unit(wi) };
}

/** pi f cos(theta_i) of a model for a pair, per channel. */
export function values(of: Model, { wo, wi }: Pair, color: Vec3, roughness: number): Triple {
  const one = (rho: number): number => piFCos(of, wo, wi, rho, roughness);
  return [one(color[0]), one(color[1]), one(color[2])];
}

/** The difference a - b in the channel with the largest difference. */
export function apart(a: Vec3, b: Vec3): number {
  const each = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  return each.reduce((most, one) => (Math.abs(one) > Math.abs(most) ? one : most));
}

/** Smaller errors are due to rounding in float32, which a shader's value accumulates. */
const ROUNDING = 64 * 2 ** -24;

/** Whether two values differ by more than rounding. */
export function isOther(value: Vec3, other: Vec3): boolean {
  return !(Math.abs(apart(value, other)) < ROUNDING);
}

/** A point on the sphere, viewed along -z. */
export interface Point extends Pair {
  readonly normal: Triple;
  readonly apart: number;
}

const GRID = 96;

/** The point on the sphere where two models differ most in this light. */
export function worstPoint(first: Model, second: Model, state: State): Point {
  const light = lightVector(state);
  let worst: Point | null = null;
  for (let row = 0; row < GRID; row++) {
    for (let column = 0; column < GRID; column++) {
      const x = (2 * column + 1) / GRID - 1;
      const y = 1 - (2 * row + 1) / GRID;
      const squared = 1 - x * x - y * y;
      if (squared <= 0.0) continue;
      const normal: Triple = [x, y, Math.sqrt(squared)];
      if (dot(normal, light) <= 0.0) continue;
      const pair = pairOf(normal, [0, 0, 1], light);
      const { color, roughness } = state;
      const difference = apart(
        values(first, pair, color, roughness),
        values(second, pair, color, roughness),
      );
      if (!worst || Math.abs(difference) > Math.abs(worst.apart)) {
        worst = { ...pair, normal, apart: difference };
      }
    }
  }
  return worst && Math.abs(worst.apart) > 1e-12 ? worst : facingPoint(state);
}

/** A point whose normal is halfway between the viewer's and the light's directions. */
export function facingPoint(state: State): Point {
  const light = lightVector(state);
  const half = unit([light[0], light[1], light[2] + 1.0 + 1e-9]);
  return { ...pairOf(half, [0, 0, 1], light), normal: half, apart: 0 };
}

const STEPS = 20;

/** The largest signed difference of two models over all pairs of directions. */
export function largestApart(first: Model, second: Model, color: Vec3, roughness: number): number {
  let most = 0.0;
  for (let o = 0; o <= STEPS; o++) {
    const thetaO = (o / STEPS) * 89.9 * RADIAN;
    const wo: Triple = [Math.sin(thetaO), 0, Math.cos(thetaO)];
    for (let i = 0; i <= STEPS; i++) {
      const thetaI = (i / STEPS) * 89.9 * RADIAN;
      for (let p = 0; p <= STEPS; p++) {
        const phi = (p / STEPS) * Math.PI;
        const [S, z] = [Math.sin(thetaI), Math.cos(thetaI)];
        const pair: Pair = { wo, wi: [S * Math.cos(phi), S * Math.sin(phi), z] };
        const one = apart(
          values(first, pair, color, roughness),
          values(second, pair, color, roughness),
        );
        if (Math.abs(one) > Math.abs(most)) most = one;
      }
    }
  }
  return most;
}
