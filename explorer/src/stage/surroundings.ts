// SPDX-License-Identifier: Apache-2.0
// Formulas for the radiance of surroundings, drawn to maps with MaterialX's latitude and longitude.

import type { Texels, Triple, Vec3 } from "../data";
import type { Surroundings } from "../state";
import { dot, unit } from "./scenes";

/** RGBA for each direction, top row first; the middle column looks along -z. */
interface SkyMap {
  readonly width: number;
  readonly height: number;
  readonly pixels: Float32Array<ArrayBuffer>;
}

const RADIANCE_ROWS = 64;
const IRRADIANCE_ROWS = 32; // rows of the irradiance map; a cosine lobe blurs finer detail
const BRIGHTNESS = 0.6; // scale that leaves headroom for the light at exposure 0
const SUMMED_ROWS = 32; // rows of the radiance map that is integrated for the irradiance

function mixed(a: Vec3, b: Vec3, share: number): Triple {
  const t = Math.min(Math.max(share, 0), 1);
  return [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t];
}

function scaled(a: Vec3, by: number): Triple {
  return [a[0] * by, a[1] * by, a[2] * by];
}

function sum(...all: Vec3[]): Triple {
  return all.reduce<Triple>((a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]], [0, 0, 0]);
}

/** 1 inside, 0 outside, with an edge of the given width around 0. */
function inside(distance: number, edge: number): number {
  const t = Math.min(Math.max(0.5 - distance / edge, 0), 1);
  return t * t * (3 - 2 * t);
}

/**
 * Coverage of a direction by a rectangular light around `toward` with half sizes `wide` and `high`.
 */
function panel(direction: Vec3, toward: Vec3, wide: number, high: number): number {
  const forward = unit(toward);
  const ahead = dot(direction, forward);
  if (ahead <= 0) return 0;
  const right = unit([forward[2], 0, -forward[0]]);
  const up = sum(direction, scaled(forward, -ahead), scaled(right, -dot(direction, right)));
  const height = Math.sqrt(dot(up, up)) / ahead;
  return inside(Math.abs(dot(direction, right)) / ahead - wide, 0.12) * inside(height - high, 0.12);
}

/**
 * A dark room with a warm light above and in front, and a cool strip behind on either side. Left
 * and right are symmetric, so that a wipe only shows differences of the materials.
 */
function studio(w: Vec3): Triple {
  const room = mixed([0.05, 0.05, 0.055], [0.15, 0.15, 0.16], 0.5 + 0.5 * w[1]);
  const key = scaled([4.0, 3.7, 3.3], panel(w, [0, 0.8, 0.75], 0.75, 0.4));
  const across: Vec3 = [Math.abs(w[0]), w[1], w[2]];
  const strips = scaled([2.6, 3.2, 4.2], panel(across, [0.9, 0.1, -0.4], 0.16, 0.9));
  return sum(room, key, strips);
}

/** A clear sky late in the day above dry ground, with a glow around the sun. */
function sky(w: Vec3): Triple {
  const glow = Math.max(dot(w, unit([0.6, 0.3, 0.75])), 0);
  const above = mixed([0.95, 0.85, 0.74], [0.18, 0.36, 0.78], Math.max(w[1], 0) ** 0.42);
  const sun = sum(
    scaled([1.0, 0.62, 0.3], 2.4 * glow ** 24),
    scaled([1, 0.8, 0.6], 0.5 * glow ** 4),
  );
  const ground = mixed([0.4, 0.34, 0.28], [0.16, 0.13, 0.11], Math.max(-w[1], 0) ** 0.5);
  return mixed(ground, sum(above, sun), inside(-w[1], 0.06));
}

const RADIANCE: Record<"studio" | "sky", (w: Vec3) => Triple> = { studio, sky };

/** The radiance map of the surroundings; uniform surroundings have a single pixel. */
export function radianceMap(name: Surroundings, own: Texels | null): SkyMap {
  if (name === "own") {
    // The address may come from a page with a custom environment, which is missing here.
    if (!own) return radianceMap("studio", null);
    const bytes = Uint8Array.from(atob(own.rgba), (each) => each.charCodeAt(0));
    return { ...own, pixels: new Float32Array(bytes.buffer) };
  }
  if (name === "none" || name === "uniform") {
    const radiance = name === "uniform" ? 1 : 0;
    return { width: 1, height: 1, pixels: new Float32Array([radiance, radiance, radiance, 1]) };
  }
  return mapOf(RADIANCE_ROWS, (direction) => scaled(RADIANCE[name](direction), BRIGHTNESS));
}

/**
 * Irradiance over pi for every normal. The weights for a normal add up to 1, as in a cosine lobe.
 */
export function irradianceMap(radiance: SkyMap): SkyMap {
  if (radiance.height === 1) return radiance;
  const coarse = reduced(radiance, radiance.height / SUMMED_ROWS);
  const incoming = Float64Array.from(
    directions(SUMMED_ROWS).flatMap(({ direction, solidAngle }) => [...direction, solidAngle]),
  );
  return mapOf(IRRADIANCE_ROWS, ([x, y, z]) => {
    // The loop must not allocate objects, because four million terms delay the first picture.
    let [red, green, blue, weights] = [0, 0, 0, 0];
    for (let k = 0; k < incoming.length; k += 4) {
      const cosine = x * incoming[k]! + y * incoming[k + 1]! + z * incoming[k + 2]!;
      if (cosine <= 0) continue;
      const weight = cosine * incoming[k + 3]!;
      weights += weight;
      red += weight * coarse[k]!;
      green += weight * coarse[k + 1]!;
      blue += weight * coarse[k + 2]!;
    }
    return [red / weights, green / weights, blue / weights];
  });
}

function mapOf(rows: number, color: (direction: Vec3) => Vec3): SkyMap {
  const pixels = new Float32Array(8 * rows * rows);
  directions(rows).forEach(({ direction }, index) => {
    pixels.set(color(direction), 4 * index);
    pixels[4 * index + 3] = 1;
  });
  return { width: 2 * rows, height: rows, pixels };
}

/**
 * Directions of the pixels of a map with `rows` rows, and their solid angles up to a constant
 * factor.
 */
function directions(rows: number): { direction: Triple; solidAngle: number }[] {
  return Array.from({ length: 2 * rows * rows }, (_, index) => {
    const polar = (Math.PI * (Math.floor(index / (2 * rows)) + 0.5)) / rows;
    const azimuth = 2 * Math.PI * (((index % (2 * rows)) + 0.5) / (2 * rows) - 0.5);
    const S = Math.sin(polar);
    return {
      direction: [S * Math.sin(azimuth), Math.cos(polar), -S * Math.cos(azimuth)],
      solidAngle: S,
    };
  });
}

/** Averages of square blocks. */
function reduced({ width, height, pixels }: SkyMap, block: number): Float32Array {
  const columns = width / block;
  const means = new Float32Array((4 * columns * height) / block);
  for (let index = 0; index < pixels.length; ++index) {
    const pixel = Math.floor(index / 4);
    const row = Math.floor(pixel / width / block);
    const column = Math.floor((pixel % width) / block);
    const at = 4 * (row * columns + column) + (index % 4);
    means[at] = (means[at] ?? 0) + (pixels[index] ?? 0) / (block * block);
  }
  return means;
}
