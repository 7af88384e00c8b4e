// SPDX-License-Identifier: Apache-2.0
// The stage draws a state after each change, refines the picture at rest, and then stops.

import type { PageData, ShaderSource, Triple, Vec3 } from "../data";
import type { SideName, State } from "../state";
import type { Errors } from "../verdict";
import { SIDES } from "../view";
import { diameterOf, Engine } from "./engine";
import { Pace } from "./pace";
import type { Size } from "./paths";
import {
  camera,
  fromSide,
  lightAt,
  lightMark,
  lightVector,
  localPair,
  toSide,
  toView,
  unit,
} from "./scenes";

export interface Pick {
  readonly wo: Triple; // unit vector in the x-z plane of the local frame, where the normal is +z
  readonly wi: Triple; // unit vector to the light; z may be <= 0
  readonly normal: Triple;
}

export type Status =
  | {
      readonly kind: "drawn";
      readonly width: number;
      readonly height: number;
      readonly milliseconds: number;
    }
  | { readonly kind: "compiling"; readonly source: string }
  | {
      readonly kind: "samples";
      readonly done: number;
      readonly of: number;
      readonly noise: { readonly left: number; readonly right: number } | null;
    }
  | { readonly kind: "error"; readonly source: string; readonly message: string }
  | { readonly kind: "lost" }
  | { readonly kind: "restored" };

const MOST_PIXELS = 1.6e6; // each pixel takes 150 bytes
const ATTRIBUTES: WebGLContextAttributes = {
  alpha: true,
  antialias: false,
  depth: false,
  stencil: false,
};

/** The canvas' size in screen pixels: even, so that the sphere's center is a pixel corner. */
function fitted({ clientWidth, clientHeight }: HTMLCanvasElement): Size {
  const most = Math.sqrt(MOST_PIXELS / Math.max(clientWidth * clientHeight, 1));
  const ratio = Math.min(window.devicePixelRatio, most);
  const even = (length: number) => Math.max(2 * Math.round((length * ratio) / 2), 2);
  return [even(clientWidth), even(clientHeight)];
}

/** A stage on a canvas; null unless WebGL2 can draw into float32 frames. */
export function createStage(canvas: HTMLCanvasElement, data: PageData): Stage | null {
  // Resize the canvas before the context exists. Later, resizing would wait for the driver.
  [canvas.width, canvas.height] = fitted(canvas);
  const gl = canvas.getContext("webgl2", ATTRIBUTES) as WebGL2RenderingContext | null;
  if (!gl?.getExtension("EXT_color_buffer_float")) return null;
  return new Stage(canvas, gl, data);
}

/** A frame that the driver is drawing. */
interface Fence {
  readonly sync: WebGLSync;
  readonly since: number;
  readonly size: Size;
}

export class Stage {
  private engine: Engine | null;
  private state: State | null = null;
  private readonly listeners: ((status: Status) => void)[] = [];
  private readonly resizing: ResizeObserver;
  private request = 0;
  private index = 0; // index of the next frame of the average, or of the next path
  private readonly pace = new Pace(() => this.restart());
  private fence: Fence | null = null;
  private noise: { left: number; right: number } | null = null;
  private said = "";
  private readonly reported = new Set<string>(); // sources with reported errors

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly gl: WebGL2RenderingContext,
    private readonly data: PageData,
  ) {
    this.engine = this.makeEngine();
    canvas.addEventListener("webglcontextlost", this.lose);
    canvas.addEventListener("webglcontextrestored", this.restore);
    this.resizing = new ResizeObserver(() => this.isFitted() || this.restart());
    this.resizing.observe(canvas);
  }

  /** Show a state soon. `dragging` announces another state and permits a coarser picture. */
  draw(state: State, dragging = false): void {
    this.pace.change(dragging);
    const old = this.state;
    if (SIDES.some((side) => old?.[side].source !== state[side].source)) this.pace.renew();
    this.state = state;
    this.restart();
  }

  /**
   * The surface at a point of the picture, [0, 1]^2 from the top left; null outside the subject.
   */
  pick(x: number, y: number, state: State): Pick | null {
    const size = this.fit();
    const column = Math.min(Math.floor(fromSide(state, x) * size[0]), size[0] - 1);
    const row = Math.min(Math.floor((1 - y) * size[1]), size[1] - 1);
    const point = this.engine?.point(state, size, column, row);
    if (!point || point[0][3] !== 1) return null;
    const [normal, position] = [unit(triple(point[0])), triple(point[1])];
    const view = camera(state);
    const eye = toView(view, view.eye);
    const viewer = unit([eye[0] - position[0], eye[1] - position[1], eye[2] - position[2]]);
    const [wo, wi] = localPair(normal, viewer, toView(view, lightVector(state)));
    return { wo, wi, normal };
  }

  /** pi f cos(theta_i) of both shaders for a pair; null while compiling or on failure. */
  evaluate(
    { wo, wi }: { wo: Vec3; wi: Vec3 },
    state: State,
  ): { left: Triple; right: Triple } | null {
    const [left, right] = SIDES.map((side) => this.engine?.value(state, side, wo, wi));
    return left && right ? { left, right } : null;
  }

  /** Largest errors of a shader against its reference; null while compiling or on failure. */
  check(source: ShaderSource): Errors | null {
    return this.engine?.check(source) ?? null;
  }

  /** Error message of a source in the latest picture, or "". */
  failure(source: string): string {
    return this.engine?.errors.get(source) ?? "";
  }

  /** Convert a point of the picture to the light that the point represents. */
  toLight(x: number, y: number, state: State): { azimuth: number; elevation: number } {
    const [width, height] = this.fit();
    return lightAt(state, fromSide(state, x), y, width / height);
  }

  /** Convert a light to the point of the picture that represents the light. */
  fromLight(state: State): [number, number] {
    const [width, height] = this.fit();
    const [x, y] = lightMark(state, width / height);
    return [toSide(state, x), y];
  }

  /** Linear RGBA radiance before exposure, bottom row first; without a side, the comparison. */
  read(side?: SideName): Float32Array {
    const { state } = this;
    if (!state || !this.engine) return new Float32Array(0);
    const size = state.paths ? this.drawnSize() : this.fit();
    const pixels = (each: SideName) =>
      this.engine?.read(state, each, size, this.index) ?? new Float32Array(0);
    if (side) return pixels(side);
    if (state.comparison === "flicker") return pixels(state.shown);
    const [left, right] = [pixels("left"), pixels("right")];
    const edge = state.comparison === "side" ? 0.5 : state.wipe;
    const shown = (k: number) => ((k >> 2) % size[0]) + 0.5 < edge * size[0];
    if (state.comparison !== "difference")
      return left.map((v, k) => (shown(k) ? v : (right[k] ?? 0)));
    return left.map((v, k) => (k % 4 === 3 ? v : v - (right[k] ?? 0)));
  }

  size(): { width: number; height: number } {
    const [width, height] = this.fit();
    return { width, height };
  }

  /** Diameter of the sphere in pixels of the canvas. */
  diameter(state: State): number {
    return diameterOf(this.fit(), state);
  }

  /** Whether the picture of a state is final: nothing is drawn until something changes. */
  isSettled(state: State): boolean {
    return this.state === state && this.index > 0 && !this.request && !this.pace.moving;
  }

  /** Whether a picture of a state was drawn, final or not. */
  isDrawn(state: State): boolean {
    return this.state === state && this.index > 0 && !this.fence;
  }

  onStatus(callback: (status: Status) => void): void {
    this.listeners.push(callback);
  }

  dispose(): void {
    this.resizing.disconnect();
    this.canvas.removeEventListener("webglcontextlost", this.lose);
    this.canvas.removeEventListener("webglcontextrestored", this.restore);
    cancelAnimationFrame(this.request);
    this.pace.end();
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
    this.engine = null;
  }

  private makeEngine(): Engine {
    // Extensions belong to a context, and a restored context is new.
    for (const name of ["EXT_color_buffer_float", "OES_texture_float_linear"]) {
      this.gl.getExtension(name);
    }
    return new Engine(this.gl, this.data);
  }

  private readonly lose = (event: Event): void => {
    event.preventDefault(); // otherwise, the browser never restores the context
    this.engine = null;
    this.fence = null;
    this.tell({ kind: "lost" });
  };

  private readonly restore = (): void => {
    this.engine = this.makeEngine();
    this.tell({ kind: "restored" });
    this.restart();
  };

  private fit(): Size {
    return fitted(this.canvas);
  }

  /** Update the canvas if its size has changed. */
  private sized([width, height]: Size): Size {
    const { canvas } = this;
    if (canvas.width !== width || canvas.height !== height) {
      [canvas.width, canvas.height] = [width, height];
    }
    return [width, height];
  }

  private isFitted(): boolean {
    const [width, height] = this.fit();
    return this.canvas.width === width && this.canvas.height === height;
  }

  private drawnSize(): Size {
    return this.pace.size(this.fit());
  }

  /** Restart the average. */
  private restart(): void {
    this.index = 0;
    this.reported.clear();
    this.noise = null;
    this.schedule();
  }

  private schedule(): void {
    this.request ||= requestAnimationFrame(this.tick);
  }

  private readonly tick = (): void => {
    this.request = 0;
    const { state, engine } = this;
    if (!state || !engine || !this.canvas.clientWidth) return;
    if (this.isBusy()) return this.schedule();
    if (!this.goesOn(state, engine)) return;
    const full = this.fit();
    if (this.index === 0) this.pace.begin(full, state.paths);
    const size = this.drawnSize();
    // While the picture moves, the browser enlarges the canvas. A software driver would need more
    // time to enlarge the picture than to draw the material.
    const canvas = this.pace.moving ? size : full;
    const done = engine.frame(state, size, full, this.sized(canvas), this.index);
    this.tellErrors(engine);
    if (!done) {
      this.tell({ kind: "compiling", source: engine.waiting });
      this.schedule();
      return;
    }
    this.index += 1;
    const sync = this.gl.fenceSync(this.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    this.gl.flush();
    if (sync) this.fence = { sync, since: performance.now(), size };
    this.schedule();
  };

  /** Whether the driver is still drawing the last frame; measures the time of a finished frame. */
  private isBusy(): boolean {
    const { fence, gl } = this;
    if (!fence) return false;
    if (gl.getSyncParameter(fence.sync, gl.SYNC_STATUS) === gl.UNSIGNALED) return true;
    gl.deleteSync(fence.sync);
    this.fence = null;
    const milliseconds = performance.now() - fence.since;
    const [width, height] = fence.size;
    this.pace.measure(milliseconds, fence.size);
    this.tell({ kind: "drawn", width, height, milliseconds });
    return false;
  }

  /** Whether the average needs another frame. */
  private goesOn(state: State, engine: Engine): boolean {
    if (this.index === 0) return true;
    if (state.paths) {
      const powerOfTwo = (this.index & (this.index - 1)) === 0;
      if (this.index >= 16 && powerOfTwo) this.noise = this.measured(engine);
      this.tell({ kind: "samples", done: this.index, of: state.samples, noise: this.noise });
      return this.index < state.samples;
    }
    return this.index < this.pace.frames(this.fit());
  }

  private measured(engine: Engine): { left: number; right: number } {
    const [left, right] = SIDES.map((side) => engine.noise(side, this.drawnSize(), this.index));
    return { left: left ?? 0, right: right ?? 0 };
  }

  /** Report an error once for each view. */
  private tellErrors(engine: Engine): void {
    for (const [source, message] of engine.errors) {
      if (this.reported.has(source)) continue;
      this.reported.add(source);
      this.tell({ kind: "error", source, message });
    }
  }

  /** Report a status that differs from the last status. */
  private tell(status: Status): void {
    const said = JSON.stringify(status);
    if (said !== this.said) for (const listener of this.listeners) listener(status);
    this.said = said;
  }
}

function triple(values: Float32Array): Triple {
  return [values[0] ?? 0, values[1] ?? 0, values[2] ?? 0];
}
