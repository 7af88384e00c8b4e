// SPDX-License-Identifier: Apache-2.0
// Render targets of the canvas' size, for all passes.

import * as gpu from "./gpu";
import type { Size } from "./paths";

/** Targets of the canvas' size. */
export interface Targets {
  readonly size: Size;
  readonly geometry: gpu.Target;
  readonly lit: gpu.Target;
  readonly left: gpu.Target;
  readonly right: gpu.Target;
  readonly average: readonly [gpu.Target, gpu.Target];
}

/** One of the textures of a target. */
export function layer(target: gpu.Target, index = 0): WebGLTexture {
  return target.textures[index] as WebGLTexture;
}

export function makeTargets(gl: WebGL2RenderingContext, size: Size): Targets {
  const { float, half, gray } = gpu.formats(gl);
  const target = (...layers: gpu.Format[]) => gpu.makeTarget(gl, layers, ...size);
  const smooth = () => gpu.makeTarget(gl, [half], ...size, gl.LINEAR);
  return {
    size,
    geometry: target(float, float, float),
    lit: target(gray),
    left: target(float),
    right: target(float),
    average: [smooth(), smooth()],
  };
}

export function deleteTargets(gl: WebGL2RenderingContext, targets: Targets): void {
  const { geometry, lit, left, right, average } = targets;
  for (const target of [geometry, lit, left, right, ...average]) gpu.deleteTarget(gl, target);
}
