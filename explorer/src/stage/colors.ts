// SPDX-License-Identifier: Apache-2.0
// The color scale of differences.

import type { Vec3 } from "../data";

/** sRGB stops, equally spaced from -scale (right side brighter) to +scale (left side brighter). */
export const DIFFERENCE_COLORS: readonly Vec3[] = [
  [0.02, 0.19, 0.38],
  [0.13, 0.4, 0.67],
  [0.4, 0.66, 0.84],
  [0.74, 0.86, 0.93],
  [0.95, 0.95, 0.94],
  [0.99, 0.84, 0.7],
  [0.95, 0.6, 0.36],
  [0.8, 0.3, 0.14],
  [0.45, 0.11, 0.04],
];

/** Decode an sRGB value to a linear value. */
export function linear(encoded: number): number {
  return encoded <= 0.04045 ? encoded / 12.92 : ((encoded + 0.055) / 1.055) ** 2.4;
}
