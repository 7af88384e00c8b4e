// SPDX-License-Identifier: Apache-2.0
// Color to enter for a given albedo: the TypeScript version of python/mxeon/models/diffuse.py for
// EON, and bisection for the other models.

import { C1, C2 } from "./formulas";

/** Reflectance for which EON has this directional albedo at normal incidence: Eqs. (28) to (31). */
export function eonRhoFromAlbedoNormal(color: number, roughness: number): number {
  const b = 1.0 + (C1 - C2) * roughness * color;
  const d = 1.0 + C1 * roughness;
  const rho = (2.0 * color * d) / (b + Math.sqrt(b * b + 4.0 * C2 * roughness * d * color));
  return Math.min(rho, 1.0);
}

/** Reflectance for which EON has this average albedo: [Portsmouth2025], Eqs. (29), (33). */
export function eonRhoFromAlbedoAvg(color: number, roughness: number): number {
  const scaled = color * (1.0 + C1 * roughness);
  return scaled / (scaled + (1.0 + C2 * roughness) * (1.0 - color));
}

/**
 * Argument in [0, 1] where an increasing function has this value, or the nearer end of the
 * interval.
 */
export function bisect(growing: (rho: number) => number, value: number): number {
  if (growing(1.0) <= value) return 1.0;
  if (growing(0.0) >= value) return 0.0;
  let [low, high] = [0.0, 1.0];
  for (let step = 0; step < 48; step++) {
    const middle = 0.5 * (low + high);
    if (growing(middle) < value) low = middle;
    else high = middle;
  }
  return 0.5 * (low + high);
}
