// SPDX-License-Identifier: Apache-2.0
// Program texts and uniforms to draw a side of the comparison.

import type { ShaderSource, Source, Vec3 } from "../data";
import type { ModelName } from "../models/table";
import type { Shape, Side, State } from "../state";
import { valuesOf } from "../view";
import type { Uniforms, UniformValue } from "./gpu";
import type { Camera } from "./scenes";
import { hasTable, type Text, type Texts } from "./texts";
import type { Textures } from "./textures";

// Samples of the surroundings per pixel, for a generated shader's glossy lobes.
const SPECULAR_SAMPLES = 16;
const MIPS = 8; // mip levels of a map with 128 columns

const ATLAS = /^uniform vec2 (\w+_uv_scale);/gm;

/** The model of a source, or null. */
export function modelOf(source: Source, flag: boolean): ModelName | null {
  if (source.kind === "model") return source.model;
  return source.actual && (flag ? source.actual.on : source.actual.off);
}

/**
 * Program that traces paths: uses the source's generated text for path tracers, or else its model.
 */
export function pathText(texts: Texts, source: Source, side: Side, shape: Shape): Text {
  if (source.kind === "shader" && source.paths) return texts.paths(source, shape);
  const model = modelOf(source, side.flag);
  if (!model) throw new Error("path tracing needs eonlib, or a material that is one diffuse node");
  return texts.modelPaths(model, side.sampler, shape);
}

/** Programs of a side; throws an error if the side cannot be drawn. */
export function wanted(texts: Texts, source: Source, side: Side, state: State): Text[] {
  if (state.paths) return [pathText(texts, source, side, state.shape)];
  if (source.kind === "shader") return [texts.generated(source)];
  const value = texts.model(source.model);
  return hasTable(source.model) ? [value, texts.albedo(source.model)] : [value];
}

/**
 * Uniforms of a generated shader: its inputs, and MaterialX's light, viewer and surroundings.
 * `light` and `eye` are in the viewer's frame, which these shaders use.
 */
export function shaderUniforms(
  textures: Textures,
  source: ShaderSource,
  side: Side,
  state: State,
  { axes }: Camera,
  light: Vec3,
  eye: Vec3,
): Uniforms {
  const inputs: Record<string, UniformValue> = Object.fromEntries(valuesOf(source, state, side));
  // Scales of images in an atlas are 1, because no image is packed into an atlas.
  for (const [, name = ""] of source.pixel.matchAll(ATLAS)) inputs[name] = [1, 1];
  for (const { name, image } of source.inputs) {
    if (image) inputs[name] = textures.image(image);
  }
  const even = state.surroundings === "none" || state.surroundings === "uniform";
  return {
    ...inputs,
    "u_lightData[0].type": 1,
    "u_lightData[0].direction": [-light[0], -light[1], -light[2]],
    "u_lightData[0].color": [1, 1, 1],
    "u_lightData[0].intensity": Math.PI * state.light,
    u_viewPosition: eye,
    u_envMatrix: [...axes.map((axis) => [...axis, 0]), [0, 0, 0, 1]].flat(),
    u_envRadiance: textures.surroundings(state.surroundings, "radiance"),
    u_envIrradiance: textures.surroundings(state.surroundings, "irradiance"),
    u_envRadianceMips: even ? 1 : MIPS,
    u_envRadianceSamples: SPECULAR_SAMPLES,
  };
}
