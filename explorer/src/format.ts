// SPDX-License-Identifier: Apache-2.0
// Formats numbers for readers.

import type { Vec3 } from "./data";

/** A number with the given count of significant digits and no trailing zeros: 0.39, 2.1e-8. */
export function show(value: number, digits = 3): string {
  const text = String(Number(value.toPrecision(digits)));
  return text.replace("-", "\u2212").replace("e\u2212", "e-").replace("e-", "e\u2212");
}

/** A number with a sign. */
export function signed(value: number, digits = 3): string {
  return (value > 0 ? "+" : "") + show(value, digits);
}

/** A color or a direction with a fixed number of decimals. */
export function triple(values: Vec3, decimals = 3): string {
  return `(${values.map((each) => each.toFixed(decimals).replace("-", "\u2212")).join(", ")})`;
}

/** An angle in whole degrees. */
export function degrees(radian: number): string {
  return `${Math.round((radian * 180) / Math.PI)}\u00b0`.replace("-", "\u2212");
}

/** A linear color as a hexadecimal sRGB color, clipped to the gamut of sRGB. */
export function toHex(color: Vec3): string {
  const code = (linear: number): string => {
    const x = Math.min(Math.max(linear, 0), 1);
    const encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;
    return Math.round(255 * encoded)
      .toString(16)
      .padStart(2, "0");
  };
  return `#${color.map(code).join("")}`;
}

/** A hexadecimal sRGB color as a linear color with four decimals, which distinguish all codes. */
export function fromHex(hex: string): [number, number, number] {
  const one = (start: number): number => {
    const x = parseInt(hex.slice(start, start + 2), 16) / 255;
    const linear = x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
    return Number(linear.toFixed(4));
  };
  return [one(1), one(3), one(5)];
}
