// SPDX-License-Identifier: Apache-2.0
// The passes of a frame in one WebGL2 context: geometry, shadow, both materials, picture, screen.
//
// A pass is drawn again only if its inputs change, so moving the wipe redraws no material.

import type { PageData, ReferenceTable, ShaderSource, Source, Triple, Vec3 } from "../data";
import type { SideName, State } from "../state";
import type { ErrorOf, Errors } from "../verdict";
import { ownView, SIDES } from "../view";
import { DIFFERENCE_COLORS, linear } from "./colors";
import * as gpu from "./gpu";
import { modelOf, pathText, shaderUniforms, wanted } from "./materials";
import { jitter, Paths, type Size } from "./paths";
import { bend, camera, isUnshadowed, lightVector, toView } from "./scenes";
import { hasTable, samplerRoughness, type Text, Texts } from "./texts";
import { deleteTargets, layer, makeTargets, type Targets } from "./targets";
import { Textures } from "./textures";

const ALBEDO_ANGLES = 256; // size of the albedo table of a model without a closed form
const FAR = 1e8;
const FINE_SAMPLES = 1024; // samples of glossy lobes in white surroundings, for checks of values

/** Diameter of the sphere in pixels, which is even so that pixels match pictures of the gl host. */
export function diameterOf(size: Size, state: State): number {
  return 2 * Math.round(Math.min(...size) / 2 / camera({ ...state, shape: "sphere" }).span);
}

/**
 * The largest difference and its row. Large values are compared relatively, as in checks of values.
 */
function farthest(
  values: readonly (Triple | null)[],
  expected: readonly number[],
  relative: boolean,
): readonly [number, number] {
  const errors = values.map((value, row) => {
    const own = expected.slice(3 * row, 3 * row + 3);
    const scale = relative ? Math.max(1, ...own.map(Math.abs)) : 1;
    const parts = own.map((each, k) => Math.abs((value?.[k] ?? NaN) - each) / scale);
    return Math.max(...parts); // NaN if the value is missing
  });
  const none = errors.findIndex(Number.isNaN);
  const row = none >= 0 ? none : errors.indexOf(Math.max(...errors));
  return [errors[row] ?? 0, Math.max(row, 0)];
}

/** The error against the reference, and a permitted form that matches if the error is too large. */
function nearest(
  kind: "direct" | "white",
  reference: ReferenceTable,
  values: readonly (Triple | null)[],
): ErrorOf {
  const relative = kind === "direct";
  const of = (expected: readonly number[]): number =>
    expected.length > 0 ? farthest(values, expected, relative)[0] : Infinity;
  const [error, row] = farthest(values, reference[kind], relative);
  if (error <= reference.bounds[kind]) return { error, row, form: null };
  const errors = reference.forms.map((form) => of(form[kind]));
  const least = errors.indexOf(Math.min(...errors));
  const explained = (errors[least] ?? Infinity) <= reference.bounds[kind];
  return { error, row, form: explained ? reference.forms[least]! : null };
}

export class Engine {
  private readonly texts: Texts;
  private readonly textures: Textures;
  private readonly sources: ReadonlyMap<string, Source>;
  private readonly programs: gpu.Programs;
  private readonly tables: Record<SideName, gpu.Target>;
  private readonly pixel: gpu.Target; // target for a single value
  private readonly upright: WebGLTexture; // normal for a single value: the z axis
  private readonly one: gpu.Target; // geometry of a single pixel
  private readonly drawn = new Map<string, string>(); // inputs of the last drawing of each pass
  private targets: Targets;
  private traced: Paths | null = null;
  private uniforms: gpu.Uniforms = {};
  /** Errors of programs, by source. */
  readonly errors = new Map<string, string>();
  /** The source whose program is being compiled. */
  waiting = "";

  constructor(
    private readonly gl: WebGL2RenderingContext,
    private readonly data: PageData,
  ) {
    this.texts = new Texts(data);
    this.textures = new Textures(gl, data.sky);
    this.sources = new Map(data.sources.map((source) => [source.id, source]));
    this.programs = new gpu.Programs(gl);
    const { float } = gpu.formats(gl);
    const table = () => gpu.makeTarget(gl, [float], ALBEDO_ANGLES, 1);
    this.tables = { left: table(), right: table() };
    this.pixel = gpu.makeTarget(gl, [float], 1, 1);
    this.one = gpu.makeTarget(gl, [float, float, float], 1, 1);
    this.upright = gpu.makeTexture(gl, float, 1, 1, new Float32Array([0, 0, 1, 1]));
    this.targets = makeTargets(gl, [2, 2]);
    gl.bindVertexArray(gl.createVertexArray());
    gl.disable(gl.DITHER);
  }

  /**
   * Draw frame `index` of the average onto the canvas; false while programs compile. `size` is the
   * size drawn, `full` the size at rest, and `canvas` the size of the canvas.
   */
  frame(state: State, size: Size, full: Size, canvas: Size, index: number): boolean {
    if (!this.ready(state)) return false;
    this.allocate(full);
    const averaged = state.paths ? 0 : index;
    this.prepare(state, size, averaged);
    for (const side of SIDES) {
      if (state.paths) this.path(state, side, size, index);
      else this.material(state, side, size);
    }
    this.picture(state, size, averaged, index + 1);
    const screen = this.programs.get(this.texts.screen());
    const uniforms = {
      stage_picture: layer(this.targets.average[averaged % 2 ? 1 : 0]),
      stage_canvas: [...canvas, size[0] / full[0], size[1] / full[1]],
    };
    if (screen) gpu.drawPass(this.gl, screen, null, canvas, uniforms);
    return true;
  }

  /**
   * Linear radiance of a side at the pixel centers, with alpha 1 on the subject; null while
   * compiling.
   */
  read(state: State, side: SideName, size: Size, passes: number): Float32Array | null {
    if (!this.ready(state)) return null;
    const area = [0, 0, ...size] as const;
    if (state.paths) {
      return this.traced && gpu.readPixels(this.gl, this.traced.target(side, passes), 0, area);
    }
    this.allocate(size);
    this.prepare(state, size, 0);
    this.material(state, side, size);
    return gpu.readPixels(this.gl, this.targets[side], 0, area);
  }

  /** Normal, part and position of a pixel in the viewer's frame; null while compiling. */
  point(state: State, size: Size, x: number, y: number): [Float32Array, Float32Array] | null {
    const text = this.texts.geometry(state.shape);
    const program = this.isPending("", text) ? null : this.programs.get(text);
    if (!program) return null;
    // Draw a frame of one pixel, shifted to the given position.
    const uniforms = { ...this.uniformsOf(state, size, 0), stage_jitter: [x, y] };
    gpu.drawPass(this.gl, program, this.one, [1, 1], uniforms);
    const read = (each: number) => gpu.readPixels(this.gl, this.one, each, [0, 0, 1, 1]);
    return [read(0), read(1)];
  }

  /**
   * pi f cos(theta_i) of a side's own shader for one pair; null while compiling or on failure.
   */
  value(state: State, side: SideName, wo: Vec3, wi: Vec3): Triple | null {
    const alone: State = { ...state, shape: "sphere", light: 1, surroundings: "none" };
    return this.isValued(alone, side) ? this.single(alone, side, wo, wi, {}) : null;
  }

  /** Largest errors of a shader with its own inputs; null while compiling or on failure. */
  check(source: ShaderSource): Errors | null {
    const { pairs, views } = this.data;
    const view = ownView(source);
    const lamp: State = { ...view, shape: "sphere", light: 1, surroundings: "none" };
    const white: State = { ...lamp, light: 0, surroundings: "uniform" };
    if (!source.reference || !this.isValued(lamp, "left")) return null;
    const direct = pairs.map(([wo, wi]) => this.single(lamp, "left", wo, wi, {}));
    const fine = { u_envRadianceSamples: FINE_SAMPLES };
    const round = views.map((wo) => this.single(white, "left", wo, wo, fine));
    return {
      direct: nearest("direct", source.reference, direct),
      white: nearest("white", source.reference, round),
    };
  }

  /** Whether a side's programs for `single` are compiled. */
  private isValued(state: State, side: SideName): boolean {
    const source = this.sources.get(state[side].source);
    if (!source) return false;
    const texts = wanted(this.texts, source, state[side], { ...state, paths: false });
    const pending = texts.filter((text) => this.isPending(source.id, text));
    return pending.length === 0 && !this.errors.has(source.id);
  }

  /** Radiance of a side's shader at one point, with some uniforms replaced. */
  private single(
    state: State,
    side: SideName,
    wo: Vec3,
    wi: Vec3,
    own: gpu.Uniforms,
  ): Triple | null {
    const eye: Triple = [FAR * wo[0], FAR * wo[1], FAR * wo[2]];
    this.uniforms = {
      ...this.uniformsOf(state, [1, 1], 0),
      stage_surface: this.upright,
      stage_place: this.textures.white,
      stage_light_view: wi,
      stage_eye_view: eye,
    };
    const source = this.sources.get(state[side].source)!;
    const { text, uniforms } = this.look(state, side, source, wi, eye);
    const program = this.programs.get(text);
    if (!program) return null;
    gpu.drawPass(this.gl, program, this.pixel, [1, 1], { ...this.uniforms, ...uniforms, ...own });
    const [red = 0, green = 0, blue = 0] = gpu.readPixels(this.gl, this.pixel, 0, [0, 0, 1, 1]);
    return [red, green, blue];
  }

  /** Relative standard error of a side's pixels after the given number of passes. */
  noise(side: SideName, size: Size, passes: number): number {
    return this.traced?.noise(side, size, passes) ?? 0;
  }

  /** Request all programs of a state at once, so that they compile in parallel. */
  private ready(state: State): boolean {
    this.errors.clear();
    const { texts } = this;
    const own = [texts.geometry(state.shape), texts.picture(state.shape), texts.screen()];
    if (!isUnshadowed(state.shape)) own.push(texts.shadow(state.shape));
    const missing = own.filter((text) => this.isPending("", text)).map(() => "");
    for (const side of SIDES) {
      const source = this.sources.get(state[side].source);
      if (!source) continue;
      try {
        for (const text of wanted(texts, source, state[side], state)) {
          if (this.isPending(source.id, text)) missing.push(source.id);
        }
      } catch (error) {
        this.errors.set(source.id, (error as Error).message);
      }
    }
    this.waiting = missing.find(Boolean) ?? "";
    return missing.length === 0;
  }

  private isPending(source: string, text: Text): boolean {
    try {
      return this.programs.get(text) === null;
    } catch (error) {
      this.errors.set(source, (error as Error).message);
      return false;
    }
  }

  private allocate(size: Size): void {
    const { targets, gl } = this;
    if (targets.size[0] === size[0] && targets.size[1] === size[1]) return;
    deleteTargets(gl, targets);
    this.traced?.delete();
    this.traced = null;
    this.targets = makeTargets(gl, size);
    this.drawn.clear();
  }

  /** Uniforms that all passes of a frame share. */
  private uniformsOf(state: State, size: Size, index: number): gpu.Uniforms {
    const view = camera(state);
    const light = lightVector(state);
    const { geometry, lit } = this.targets;
    const { white } = this.textures;
    return {
      stage_camera: view.axes.flat(),
      stage_eye: view.eye,
      stage_eye_view: toView(view, view.eye),
      stage_frame: [
        ...size,
        diameterOf(size, state),
        (view.distance * Math.min(...size)) / 2 / view.span,
      ],
      stage_jitter: jitter(index),
      stage_light: light,
      stage_light_view: toView(view, light),
      stage_intensity: state.light,
      stage_bend: bend(state.shape),
      stage_rho: state.color,
      stage_parameter: state.roughness,
      stage_surface: layer(geometry),
      stage_place: layer(geometry, 1),
      stage_detail: layer(geometry, 2),
      stage_lit: isUnshadowed(state.shape) ? white : layer(lit),
      stage_environment: this.textures.surroundings(state.surroundings, "radiance"),
      stage_irradiance: this.textures.surroundings(state.surroundings, "irradiance"),
      stage_before: white,
      stage_before_square: white,
    };
  }

  /** Draw the geometry and the shadow. */
  private prepare(state: State, size: Size, index: number): void {
    this.uniforms = this.uniformsOf(state, size, index);
    const { geometry, lit } = this.targets;
    const seen = JSON.stringify([state.shape, camera(state), size, index]);
    this.pass("geometry", seen, this.texts.geometry(state.shape), geometry, size, {});
    if (isUnshadowed(state.shape)) return;
    const light = JSON.stringify([seen, lightVector(state)]);
    this.pass("lit", light, this.texts.shadow(state.shape), lit, size, {});
  }

  /** Draw a pass if its inputs have changed. */
  private pass(
    name: string,
    key: string,
    text: Text,
    target: gpu.Target,
    size: Size,
    uniforms: gpu.Uniforms,
  ): void {
    if (this.drawn.get(name) === key) return;
    this.drawn.set(name, key);
    const program = this.programs.get(text);
    if (program) gpu.drawPass(this.gl, program, target, size, { ...this.uniforms, ...uniforms });
  }

  /** Draw a side's material, unless the material fails. */
  private material(state: State, side: SideName, size: Size): void {
    const source = this.sources.get(state[side].source);
    if (!source || this.errors.has(source.id)) {
      this.drawn.delete(side);
      gpu.clear(this.gl, this.targets[side]);
      return;
    }
    const { color, roughness, light, surroundings } = state;
    const inputs = state.inputs[source.id];
    const seen = [source.id, state[side].flag, color, roughness, light, surroundings, inputs];
    const place = [this.drawn.get("geometry"), lightVector(state)];
    const view = camera(state);
    const eye = toView(view, view.eye);
    const { text, uniforms } = this.look(
      state,
      side,
      source,
      toView(view, lightVector(state)),
      eye,
    );
    this.pass(side, JSON.stringify([seen, place]), text, this.targets[side], size, uniforms);
  }

  /**
   * Program and uniforms of a side's material, and its table of albedos; `light` is in the viewer's
   * frame.
   */
  private look(state: State, side: SideName, source: Source, light: Vec3, eye: Vec3) {
    if (source.kind === "shader") {
      const view = camera(state);
      const uniforms = shaderUniforms(this.textures, source, state[side], state, view, light, eye);
      return { text: this.texts.generated(source), uniforms };
    }
    const table = this.tables[side];
    if (hasTable(source.model)) {
      const key = JSON.stringify([source.model, state.color, state.roughness]);
      const text = this.texts.albedo(source.model);
      this.pass(`table ${side}`, key, text, table, [ALBEDO_ANGLES, 1], {});
    }
    return { text: this.texts.model(source.model), uniforms: { stage_albedos: layer(table) } };
  }

  /** Add one path per pixel to a side's average. */
  private path(state: State, side: SideName, size: Size, index: number): void {
    this.traced ??= new Paths(this.gl, this.targets.size);
    const source = this.sources.get(state[side].source);
    if (!source || this.errors.has(source.id)) {
      this.traced.draw(side, null, size, index, {});
      return;
    }
    const view = camera(state);
    const [light, eye] = [toView(view, lightVector(state)), toView(view, view.eye)];
    const model = modelOf(source, state[side].flag);
    const program = this.programs.get(pathText(this.texts, source, state[side], state.shape));
    this.traced.draw(side, program, size, index, {
      ...(source.kind === "shader" &&
        shaderUniforms(this.textures, source, state[side], state, view, light, eye)),
      ...this.uniforms,
      stage_roughness: model ? samplerRoughness(model, state.roughness) : 0,
    });
  }

  /** Compare the sides in frame `index` of the average, after the given number of passes. */
  private picture(state: State, size: Size, index: number, passes: number): void {
    const { average } = this.targets;
    const [now, before] = index % 2 ? [average[1], average[0]] : average;
    const program = this.programs.get(this.texts.picture(state.shape));
    if (!program) return;
    const side = (name: SideName) =>
      layer((state.paths && this.traced?.target(name, passes)) || this.targets[name]);
    const [width] = size;
    const flicks = state.comparison === "flicker";
    const sideBySide = state.comparison === "side";
    const flicker = state.shown === "left" ? 2 * width : -width;
    gpu.drawPass(this.gl, program, now, size, {
      ...this.uniforms,
      stage_left: side("left"),
      stage_right: side("right"),
      stage_before: layer(before),
      stage_share: 1 / (index + 1),
      stage_gain: 2 ** state.exposure,
      stage_edge: flicks ? flicker : (sideBySide ? 0.5 : state.wipe) * width,
      stage_shift: sideBySide ? Math.round(width / 4) : 0,
      stage_scale: state.comparison === "difference" ? state.scale : 0,
      stage_colors: DIFFERENCE_COLORS.flat().map(linear),
      stage_traced: state.paths,
      stage_backdrop: state.surroundings !== "none" && state.surroundings !== "uniform",
    });
  }
}
