// SPDX-License-Identifier: Apache-2.0
// The passes of a frame, in one WebGL2 context: geometry, shadow, both materials, picture, screen.
//
// What a pass reads decides whether it is drawn again: a wipe that moves draws no material anew.

import type { ModelName, PageData, ShaderSource, Source } from "../data";
import type { Side, SideName, State, Surroundings } from "../state";
import { DIFFERENCE_COLORS, linear } from "./colors";
import * as gpu from "./gpu";
import { camera, lightVector, toView } from "./scenes";
import { irradianceMap, radianceMap } from "./surroundings";
import { hasTable, samplerRoughness, Texts } from "./texts";

export const SIDES = ["left", "right"] as const satisfies readonly SideName[];

const BOUNCES = 6;
const ALBEDO_ANGLES = 256;
const NOISE_BLOCK = 256; // pixels on a side of what the noise is measured in

export type Size = readonly [number, number];
type Pair = [gpu.Target, gpu.Target];

/** The pictures of the sides while paths are averaged: the latest is that of `count` % 2. */
interface Traced {
  readonly left: Pair;
  readonly right: Pair;
}

/** Diameter of the sphere in pixels: even, so that its pixels are those of the gl host's picture. */
export function diameterOf(size: Size): number {
  return 2 * Math.round(Math.min(...size) / 2 / camera("sphere").span);
}

/** The model that a source is, for path tracing; null if it has none. */
export function modelOf(source: Source, flag: boolean): ModelName | null {
  if (source.kind === "model") return source.model;
  return source.actual && (flag ? source.actual.on : source.actual.off);
}

export class Engine {
  private readonly gl: WebGL2RenderingContext;
  private readonly texts: Texts;
  private readonly sources: ReadonlyMap<string, Source>;
  private readonly programs: gpu.Programs;
  private readonly format: ReturnType<typeof gpu.formats>;
  private readonly white: WebGLTexture;
  private readonly maps = new Map<string, WebGLTexture>();
  private readonly images = new Map<object, WebGLTexture>();
  private readonly albedos: Record<SideName, gpu.Target>;
  private readonly drawn = new Map<string, string>(); // what each pass was last drawn from
  private allocated: Size = [0, 0];
  private geometry!: gpu.Target;
  private lit!: gpu.Target;
  private sides!: Record<SideName, gpu.Target>;
  private average!: Pair;
  private traced: Traced | null = null;
  private uniforms: gpu.Uniforms = {};
  /** Errors of programs by the source they belong to. */
  readonly errors = new Map<string, string>();
  /** Source whose program is compiled now. */
  waiting = "";

  constructor(gl: WebGL2RenderingContext, data: PageData) {
    this.gl = gl;
    this.texts = new Texts(data);
    this.sources = new Map(data.sources.map((source) => [source.id, source]));
    this.programs = new gpu.Programs(gl);
    this.format = gpu.formats(gl);
    this.white = gpu.makeTexture(gl, this.format.bytes, 1, 1, new Uint8Array([255, 255, 255, 255]));
    const table = () => gpu.makeTarget(gl, [this.format.float], ALBEDO_ANGLES, 1);
    this.albedos = { left: table(), right: table() };
    gl.bindVertexArray(gl.createVertexArray());
    gl.disable(gl.DITHER);
  }

  /** Draw frame `index` of the average onto the canvas; false while programs are compiled. */
  frame(state: State, size: Size, canvas: Size, index: number): boolean {
    if (!this.ready(state)) return false;
    this.allocate(canvas);
    this.prepare(state, size, state.paths ? 0 : index);
    for (const side of SIDES) this.material(state, side, size);
    if (state.paths) for (const side of SIDES) this.path(state, side, size, index);
    this.picture(state, size, state.paths ? 0 : index, index);
    const last = this.average[state.paths ? 0 : index % 2];
    const share = [size[0] / canvas[0], size[1] / canvas[1]];
    const screen = this.programs.get(this.texts.screen());
    const uniforms = { stage_picture: last?.textures[0] ?? this.white, stage_canvas: [...canvas, ...share] };
    if (screen) gpu.drawPass(this.gl, screen, null, canvas, uniforms);
    return true;
  }

  /** Linear radiance of a side at the pixels' centers, alpha 1 on the subject; null while compiling. */
  read(state: State, side: SideName, size: Size, samples: number): Float32Array<ArrayBuffer> | null {
    if (!this.ready(state)) return null;
    const area = [0, 0, ...size] as const;
    if (state.paths && this.traced) {
      return gpu.readPixels(this.gl, this.latest(side, samples), 0, area);
    }
    this.allocate(size);
    this.prepare(state, size, 0);
    this.material(state, side, size);
    return gpu.readPixels(this.gl, this.sides[side], 0, area);
  }

  /** Normal and part, and position, of a pixel, in the viewer's frame; null while compiling. */
  point(state: State, size: Size, x: number, y: number): [Float32Array, Float32Array] | null {
    if (!this.ready(state)) return null;
    this.allocate(size);
    this.prepare(state, size, 0);
    const read = (layer: number) => gpu.readPixels(this.gl, this.geometry, layer, [x, y, 1, 1]);
    return [read(0), read(1)];
  }

  /** Standard error over the mean of a side's pixels, in the middle of the picture, 0 without light. */
  noise(side: SideName, size: Size, samples: number): number {
    const [width, height] = [Math.min(size[0], NOISE_BLOCK), Math.min(size[1], NOISE_BLOCK)];
    const area = [(size[0] - width) >> 1, (size[1] - height) >> 1, width, height] as const;
    const means = gpu.readPixels(this.gl, this.latest(side, samples), 0, area);
    const squares = gpu.readPixels(this.gl, this.latest(side, samples), 1, area);
    let [sum, variance, count] = [0, 0, 0];
    for (let k = 0; k < means.length; k += 4) {
      if (means[k + 3] !== 1) continue;
      const mean = ((means[k] ?? 0) + (means[k + 1] ?? 0) + (means[k + 2] ?? 0)) / 3;
      sum += mean;
      variance += Math.max((squares[k] ?? 0) - mean * mean, 0) / Math.max(samples - 1, 1);
      count += 1;
    }
    return sum > 0 ? Math.sqrt(variance / count) / (sum / count) : 0;
  }

  /** Ask for all programs of a state, so that they are compiled side by side. */
  private ready(state: State): boolean {
    this.errors.clear();
    const { texts } = this;
    const wanted: [string, string][] = [
      ["", texts.geometry(state.shape)],
      ["", texts.picture(state.shape)],
      ["", texts.screen()],
    ];
    if (state.shape !== "sphere") wanted.push(["", texts.shadow(state.shape)]);
    for (const side of SIDES) wanted.push(...this.textsOf(state, state[side]));
    const missing = wanted.filter(([source, text]) => this.isPending(source, text));
    this.waiting = missing.map(([source]) => source).find(Boolean) ?? "";
    return missing.length === 0;
  }

  private isPending(source: string, text: string): boolean {
    try {
      return this.programs.get(text) === null;
    } catch (error) {
      this.errors.set(source, (error as Error).message);
      return false;
    }
  }

  /** Source and text of each program that draws a side. */
  private textsOf(state: State, side: Side): [string, string][] {
    const source = this.sources.get(side.source);
    if (!source) return [];
    const model = modelOf(source, side.flag);
    if (state.paths) {
      if (model) return [[source.id, this.texts.paths(model, side.sampler, state.shape)]];
      this.errors.set(source.id, "path tracing needs a material that is one diffuse node");
      return [];
    }
    if (source.kind === "shader") return [[source.id, this.texts.generated(source)]];
    const value: [string, string] = [source.id, this.texts.model(source.model)];
    return hasTable(source.model) ? [value, [source.id, this.texts.albedo(source.model)]] : [value];
  }

  private allocate(size: Size): void {
    const { gl, format } = this;
    if (this.allocated[0] === size[0] && this.allocated[1] === size[1]) return;
    if (this.allocated[0]) {
      const { left, right } = this.sides;
      const traced = this.traced ? [...this.traced.left, ...this.traced.right] : [];
      for (const target of [this.geometry, this.lit, left, right, ...this.average, ...traced]) {
        gpu.deleteTarget(gl, target);
      }
    }
    const target = (...layers: gpu.Format[]) => gpu.makeTarget(gl, layers, ...size, gl.NEAREST);
    const smooth = () => gpu.makeTarget(gl, [format.half], ...size, gl.LINEAR);
    this.geometry = target(format.float, format.float, format.float);
    this.lit = target(format.gray);
    this.sides = { left: target(format.float), right: target(format.float) };
    this.average = [smooth(), smooth()];
    this.traced = null;
    this.allocated = size;
    this.drawn.clear();
  }

  /** Uniforms of a frame, the geometry and the shadow. */
  private prepare(state: State, size: Size, index: number): void {
    const view = camera(state.shape);
    const light = lightVector(state);
    const jitter = jitterOf(index);
    const { geometry, white } = this;
    const sphere = state.shape === "sphere";
    this.uniforms = {
      stage_camera: view.axes.flat(),
      stage_eye: view.eye,
      stage_eye_view: toView(view, view.eye),
      stage_frame: [...size, diameterOf(size), (view.distance * Math.min(...size)) / 2 / view.span],
      stage_jitter: jitter,
      stage_light: light,
      stage_light_view: toView(view, light),
      stage_intensity: state.light,
      stage_rho: state.color,
      stage_parameter: state.roughness,
      stage_surface: geometry.textures[0] ?? white,
      stage_place: geometry.textures[1] ?? white,
      stage_detail: geometry.textures[2] ?? white,
      stage_lit: sphere ? white : (this.lit.textures[0] ?? white),
      stage_environment: this.map(state.surroundings, "radiance"),
      stage_irradiance: this.map(state.surroundings, "irradiance"),
      stage_before: white,
      stage_before_square: white,
    };
    const seen = JSON.stringify([state.shape, size, jitter]);
    this.pass("geometry", seen, this.texts.geometry(state.shape), geometry, size, {});
    if (!sphere) {
      const lit = JSON.stringify([seen, light]);
      this.pass("lit", lit, this.texts.shadow(state.shape), this.lit, size, {});
    }
  }

  /** Draw a pass if it or what it reads has changed. */
  private pass(
    name: string,
    key: string,
    text: string,
    target: gpu.Target,
    size: Size,
    uniforms: gpu.Uniforms,
  ): void {
    if (this.drawn.get(name) === key) return;
    this.drawn.set(name, key);
    const program = this.programs.get(text);
    if (program) gpu.drawPass(this.gl, program, target, size, { ...this.uniforms, ...uniforms });
  }

  /** Draw a side's material, or nothing if it has none that works. */
  private material(state: State, side: SideName, size: Size): void {
    const source = this.sources.get(state[side].source);
    if (!source || this.errors.has(source.id) || state.paths) {
      this.drawn.delete(side);
      this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, this.sides[side].frame);
      this.gl.clearBufferfv(this.gl.COLOR, 0, [0, 0, 0, 0]);
      return;
    }
    const { color, roughness, light, surroundings } = state;
    const inputs = state.inputs[source.id];
    const { flag } = state[side];
    const before = [this.drawn.get("geometry"), this.drawn.get("lit")];
    const seen = [before, source.id, flag, color, roughness, light, surroundings, inputs];
    const key = JSON.stringify([...seen, state.azimuth, state.elevation]);
    if (source.kind === "shader") {
      const values = this.shaderUniforms(source, state, flag);
      this.pass(side, key, this.texts.generated(source), this.sides[side], size, values);
      return;
    }
    const table = this.albedos[side];
    if (hasTable(source.model)) {
      const numbers = JSON.stringify([source.model, color, roughness]);
      const text = this.texts.albedo(source.model);
      this.pass(`albedo ${side}`, numbers, text, table, [ALBEDO_ANGLES, 1], {});
    }
    const values = { stage_albedos: table.textures[0] ?? this.white };
    this.pass(side, key, this.texts.model(source.model), this.sides[side], size, values);
  }

  /** Uniforms of a generated shader: its inputs, MaterialX's light, viewer and surroundings. */
  private shaderUniforms(source: ShaderSource, state: State, flag: boolean): gpu.Uniforms {
    const uniforms: Record<string, gpu.UniformValue> = {};
    for (const { name, value, image } of source.inputs) {
      uniforms[`${name}_uv_scale`] = [1, 1];
      uniforms[`${name}_uv_offset`] = [0, 0];
      if (image) uniforms[name] = this.image(image);
      else if (value !== null) uniforms[name] = value;
    }
    const { controls } = source;
    if (controls.color) uniforms[controls.color] = state.color;
    if (controls.roughness) uniforms[controls.roughness] = state.roughness;
    if (controls.flag) uniforms[controls.flag] = flag;
    const view = camera(state.shape);
    const [x, y, z] = toView(view, lightVector(state));
    return {
      ...uniforms,
      ...state.inputs[source.id],
      "u_lightData[0].type": 1,
      "u_lightData[0].direction": [-x, -y, -z],
      "u_lightData[0].color": [1, 1, 1],
      "u_lightData[0].intensity": Math.PI * state.light,
      u_viewPosition: toView(view, view.eye),
      u_envMatrix: [...view.axes.map((axis) => [...axis, 0]), [0, 0, 0, 1]].flat(),
      u_envRadiance: this.map(state.surroundings, "radiance"),
      u_envIrradiance: this.map(state.surroundings, "irradiance"),
      u_envRadianceMips: state.surroundings === "none" || state.surroundings === "uniform" ? 1 : 8,
      u_envRadianceSamples: 16,
    };
  }

  /** Add a path per pixel to a side's average. */
  private path(state: State, side: SideName, size: Size, index: number): void {
    const source = this.sources.get(state[side].source);
    const model = source && modelOf(source, state[side].flag);
    this.traced ??= this.makeTraced();
    const pair = this.traced[side];
    const [before, now] = index % 2 ? [pair[0], pair[1]] : [pair[1], pair[0]];
    const program =
      model && this.programs.get(this.texts.paths(model, state[side].sampler, state.shape));
    if (!program) {
      this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, now.frame);
      this.gl.clearBufferfv(this.gl.COLOR, 0, [0, 0, 0, 0]);
      return;
    }
    gpu.drawPass(this.gl, program, now, size, {
      ...this.uniforms,
      stage_before: before.textures[0] ?? this.white,
      stage_before_square: before.textures[1] ?? this.white,
      stage_jitter: jitterOf(index),
      stage_pass: index,
      stage_bounces: BOUNCES,
      stage_share: 1 / (index + 1),
      stage_roughness: samplerRoughness(model, state.roughness),
    });
  }

  private makeTraced(): Traced {
    const { float } = this.format;
    const target = () => gpu.makeTarget(this.gl, [float, float], ...this.allocated);
    return { left: [target(), target()], right: [target(), target()] };
  }

  private latest(side: SideName, samples: number): gpu.Target {
    return (this.traced ??= this.makeTraced())[side][(samples + 1) % 2 ? 1 : 0];
  }

  private picture(state: State, size: Size, index: number, pass: number): void {
    const [now, before] = [this.average[index % 2], this.average[(index + 1) % 2]];
    const program = this.programs.get(this.texts.picture(state.shape));
    if (!program || !now) return;
    const side = (name: SideName) =>
      (state.paths ? this.latest(name, pass + 1) : this.sides[name]).textures[0] ?? this.white;
    const edge = { wipe: state.wipe * size[0], flicker: state.shown === "left" ? 1e9 : -1 };
    const difference = state.comparison === "difference";
    const visible = state.surroundings !== "none" && state.surroundings !== "uniform";
    gpu.drawPass(this.gl, program, now, size, {
      ...this.uniforms,
      stage_left: side("left"),
      stage_right: side("right"),
      stage_before: before?.textures[0] ?? this.white,
      stage_share: 1 / (index + 1),
      stage_gain: 2 ** state.exposure,
      stage_edge: state.comparison === "flicker" ? edge.flicker : edge.wipe,
      stage_scale: difference ? state.scale : 0,
      stage_colors: DIFFERENCE_COLORS.flat().map(linear),
      stage_traced: state.paths,
      stage_backdrop: visible,
    });
  }

  private map(name: Surroundings, kind: "radiance" | "irradiance"): WebGLTexture {
    const known = this.maps.get(name + kind);
    if (known) return known;
    const { gl, format } = this;
    const radiance = radianceMap(name);
    const { width, height, pixels } = kind === "radiance" ? radiance : irradianceMap(radiance);
    const layout = gl.getExtension("OES_texture_float_linear") ? format.float : format.half;
    const wrap = [gl.REPEAT, gl.CLAMP_TO_EDGE] as const;
    const texture = gpu.makeTexture(gl, layout, width, height, pixels, gl.LINEAR, wrap);
    if (kind === "radiance") {
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
      gl.generateMipmap(gl.TEXTURE_2D);
    }
    this.maps.set(name + kind, texture);
    return texture;
  }

  private image(texels: { width: number; height: number; rgba: string }): WebGLTexture {
    const known = this.images.get(texels);
    if (known) return known;
    const { gl, format } = this;
    const bytes = Uint8Array.from(atob(texels.rgba), (each) => each.charCodeAt(0));
    const { width, height } = texels;
    const wrap = [gl.REPEAT, gl.REPEAT] as const;
    const texture = gpu.makeTexture(gl, format.bytes, width, height, bytes, gl.LINEAR, wrap);
    this.images.set(texels, texture);
    return texture;
  }
}

/** Offset from a pixel's center: none first, then Roberts' R2 sequence over the pixel. */
function jitterOf(index: number): [number, number] {
  if (index === 0) return [0, 0];
  const place = (step: number) => ((0.5 + index * step) % 1) - 0.5;
  return [place(0.7548776662), place(0.569840291)];
}
