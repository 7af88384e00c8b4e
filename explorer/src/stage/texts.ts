// SPDX-License-Identifier: Apache-2.0
// Builds the texts of all the stage's programs, in ESSL 3.00.

import type { PageData, ShaderSource } from "../data";
import { model as rowOf, type ModelName } from "../models/table";
import type { Sampler, Shape } from "../state";
import albedo from "./albedo.glsl";
import camera from "./camera.glsl";
import generated from "./generated.glsl";
import geometry from "./geometry.glsl";
import random from "../../../genglsl/path/random.glsl";
import material from "./material.glsl";
import modelPaths from "./model_paths.glsl";
import paths from "./paths.glsl";
import picture from "./picture.glsl";
import places from "./places.glsl";
import { SHAPE_INDEX } from "./scenes";
import screen from "./screen.glsl";
import shadow from "./shadow.glsl";
import shapes from "./shapes.glsl";
import surroundings from "./surroundings.glsl";
import variants from "./variants.glsl";

const HEAD = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
`;

/** Paths have no neighboring pixels, so textures are read without derivatives. */
const NO_MIPS = "#define texture(map, at) textureLod(map, at, 0.0)\n";

/** One triangle that covers the whole frame. */
export const VERTEX = `#version 300 es
void main() {
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
`;

/** GLSL of a model's value. */
function valueOf(model: ModelName): string {
  if (model === "lambert") return "lambert_brdf(wo, wi, rho)";
  if (model === "eon_approx") return "eon_brdf_approx(wo, wi, rho, r)";
  if (model === "qon_fitted") return "qon_brdf(wo, wi, rho, r)";
  return `${model}_brdf(wo, wi, rho, r)`;
}

/** GLSL of a model's albedo in closed form, or null. */
function albedoOf(model: ModelName): string | null {
  if (!rowOf(model).albedoDir) return null;
  if (model === "lambert") return "rho";
  const tinted = model === "qon" || model === "fon";
  return tinted ? `rho * ${model}_albedo_dir(mu, r)` : `${model}_albedo_dir(mu, rho, r)`;
}

const SAMPLERS: Record<Sampler, readonly [string, string]> = {
  exact: ["eon_sample(wo, u.x, u.y, rho, r)", "eon_pdf(wo, wi, rho, r)"],
  cltc: ["eon_cltc_sample(wo, u.x, u.y, r)", "eon_cltc_pdf(wo, wi, r)"],
  cosine: ["cosine_sample(u.x, u.y)", "cosine_pdf(wi)"],
};

/** Converts a model's parameter to the roughness that samplers take. */
export function samplerRoughness(model: ModelName, parameter: number): number {
  return rowOf(model).parameter === "sigma" ? Math.min((2 * parameter) / Math.PI, 1) : parameter;
}

export function hasTable(model: ModelName): boolean {
  return albedoOf(model) === null;
}

function defined(macros: Record<string, string | number>): string {
  return Object.entries(macros)
    .map(([name, text]) => `#define ${name} ${text}\n`)
    .join("");
}

function shaped(shape: Shape, ...parts: string[]): string {
  return HEAD + defined({ STAGE_SHAPE: SHAPE_INDEX[shape] }) + shapes + parts.join("");
}

/** Traces paths with the text of a material. */
function traced(shape: Shape, ...material: string[]): string {
  return shaped(shape, ...material, camera, surroundings, places, paths);
}

/** A program's pixel stage: a function that builds its text, and a short key for caches. */
export interface Text {
  readonly key: string;
  readonly make: () => string;
}

export class Texts {
  private readonly functions: string;

  constructor(data: PageData) {
    this.functions = data.functions + variants;
  }

  geometry(shape: Shape): Text {
    const make = () => shaped(shape, this.functions, camera, places, geometry);
    return { key: `geometry ${shape}`, make };
  }

  shadow(shape: Shape): Text {
    return { key: `shadow ${shape}`, make: () => shaped(shape, shadow) };
  }

  model(model: ModelName): Text {
    const closed = albedoOf(model) ?? "stage_tabulated(mu)";
    const macros = { STAGE_VALUE: valueOf(model), STAGE_ALBEDO: closed };
    const make = () => HEAD + this.functions + defined(macros) + surroundings + material;
    return { key: `model ${model}`, make };
  }

  albedo(model: ModelName): Text {
    const macros = { STAGE_VALUE: valueOf(model) };
    const make = () => HEAD + this.functions + defined(macros) + albedo;
    return { key: `albedo ${model}`, make };
  }

  /** Traces paths with the model of a source. */
  modelPaths(model: ModelName, sampler: Sampler, shape: Shape): Text {
    const [sample, pdf] = SAMPLERS[sampler];
    const macros = { STAGE_VALUE: valueOf(model), STAGE_SAMPLE: sample, STAGE_PDF: pdf };
    const make = () => traced(shape, this.functions, defined(macros), modelPaths, random);
    return { key: `paths ${model} ${sampler} ${shape}`, make };
  }

  /** Traces paths with a generated shader. */
  paths(source: ShaderSource, shape: Shape): Text {
    return { key: `paths ${source.id} ${shape}`, make: () => traced(shape, NO_MIPS, source.paths) };
  }

  picture(shape: Shape): Text {
    return { key: `picture ${shape}`, make: () => shaped(shape, camera, surroundings, picture) };
  }

  screen(): Text {
    return { key: "screen", make: () => HEAD + screen };
  }

  generated(source: ShaderSource): Text {
    return { key: `source ${source.id}`, make: () => withPoints(source.pixel) };
  }
}

/** Vertex-stage inputs that a shader may read, computed from the geometry. */
const POINTS: Record<string, string> = {
  normalWorld: "stage_normal",
  positionWorld: "stage_position.xyz",
  tangentWorld: "stage_tangent",
  bitangentWorld: "cross(stage_normal, stage_tangent)",
  normalObject: "stage_camera * stage_normal",
  positionObject: "stage_camera * stage_position.xyz",
  tangentObject: "stage_camera * stage_tangent",
  bitangentObject: "stage_camera * cross(stage_normal, stage_tangent)",
  texcoord_0: "stage_texcoord",
};

/**
 * A generated pixel stage that reads its point from the geometry instead of a vertex stage. Only
 * declarations change: each `in` becomes a variable, and so do two uniforms that differ from pixel
 * to pixel here: whether the light arrives, and the visible share of the surroundings. Inputs
 * missing in POINTS are zero, as on the gl host, which does not have these vertex attributes
 * either.
 */
function withPoints(pixel: string): string {
  const inputs: string[] = [];
  const text = pixel
    .replace(/^in (\w+) (\w+);/gm, (_, type: string, name: string) => {
      inputs.push(`${name} = ${POINTS[name] ?? `${type}(0.0)`};`);
      return `${type} ${name};`;
    })
    .replace(/^uniform (int u_numActiveLightSources|float u_envLightIntensity);/gm, "$1;")
    .replace(/^void main\(\)/m, "void stage_generated_main()");
  const output = /^out vec4 (\w+);/m.exec(text)?.[1] ?? "";
  return text + defined({ STAGE_OUTPUT: output, STAGE_INPUTS: inputs.join(" ") }) + generated;
}
