// SPDX-License-Identifier: Apache-2.0
// Averages of the paths of both sides, and their noise.

import type { SideName } from "../state";
import * as gpu from "./gpu";

const BOUNCES = 6;
const BLOCK = 256; // side of the square, in pixels, in which noise is measured

export type Size = readonly [number, number];
type Pair = readonly [gpu.Target, gpu.Target];

/** Offset from a pixel's center: zero first, then Roberts' R2 sequence over the pixel. */
export function jitter(index: number): [number, number] {
  if (index === 0) return [0, 0];
  const place = (step: number) => ((0.5 + index * step) % 1) - 0.5;
  return [place(0.7548776662), place(0.569840291)];
}

/** Two targets per side: each pass reads one and draws into the other. */
export class Paths {
  private readonly sides: Readonly<Record<SideName, Pair>>;

  constructor(
    private readonly gl: WebGL2RenderingContext,
    size: Size,
  ) {
    const { float, single } = gpu.formats(gl);
    const target = () => gpu.makeTarget(gl, [float, single], ...size);
    this.sides = { left: [target(), target()], right: [target(), target()] };
  }

  delete(): void {
    for (const target of [...this.sides.left, ...this.sides.right])
      gpu.deleteTarget(this.gl, target);
  }

  /** Add path `index` of each pixel to a side's average; without a program the result is black. */
  draw(
    side: SideName,
    program: gpu.Program | null,
    size: Size,
    index: number,
    uniforms: gpu.Uniforms,
  ): void {
    const before = this.target(side, index);
    const now = this.target(side, index + 1);
    if (!program) {
      gpu.clear(this.gl, now);
      return;
    }
    gpu.drawPass(this.gl, program, now, size, {
      ...uniforms,
      ...(index && { stage_before: before.textures[0], stage_before_square: before.textures[1] }),
      stage_jitter: jitter(index),
      stage_pass: index,
      stage_bounces: BOUNCES,
      stage_share: 1 / (index + 1),
    } as gpu.Uniforms);
  }

  /** The average after the given number of passes. */
  target(side: SideName, passes: number): gpu.Target {
    return this.sides[side][passes % 2 ? 1 : 0];
  }

  /** Relative standard error of a side's pixels, in the middle of the picture. */
  noise(side: SideName, size: Size, passes: number): number {
    const [width, height] = [Math.min(size[0], BLOCK), Math.min(size[1], BLOCK)];
    const area = [(size[0] - width) >> 1, (size[1] - height) >> 1, width, height] as const;
    const means = gpu.readPixels(this.gl, this.target(side, passes), 0, area);
    const squares = gpu.readPixels(this.gl, this.target(side, passes), 1, area);
    let [sum, variance, count] = [0, 0, 0];
    for (let k = 0; k < means.length; k += 4) {
      if (means[k + 3] !== 1) continue; // Skip the rim, where coverage varies.
      const mean = ((means[k] ?? 0) + (means[k + 1] ?? 0) + (means[k + 2] ?? 0)) / 3;
      sum += mean;
      variance += Math.max((squares[k] ?? 0) - mean * mean, 0) / (passes - 1);
      count += 1;
    }
    return sum > 0 ? Math.sqrt(variance / count) / (sum / count) : 0;
  }
}
