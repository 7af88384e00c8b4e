// SPDX-License-Identifier: Apache-2.0
// Programs, textures and frames in one WebGL2 context.

import { type Text, VERTEX } from "./texts";

export type UniformValue = number | boolean | readonly number[] | WebGLTexture;
export type Uniforms = Readonly<Record<string, UniformValue>>;

interface Uniform {
  readonly location: WebGLUniformLocation;
  readonly type: number;
}

export interface Program {
  readonly handle: WebGLProgram;
  readonly uniforms: ReadonlyMap<string, Uniform>;
}

interface Pending {
  readonly handle: WebGLProgram;
  readonly shader: WebGLShader;
  error: string | null;
  program: Program | null;
}

/** A frame to draw into, with its textures. */
export interface Target {
  readonly frame: WebGLFramebuffer;
  readonly textures: readonly WebGLTexture[];
}

/** Programs by pixel stage, compiled on first use. */
export class Programs {
  private readonly known = new Map<string, Pending>();
  private readonly vertex: WebGLShader;
  private readonly parallel: { readonly COMPLETION_STATUS_KHR: number } | null;

  constructor(private readonly gl: WebGL2RenderingContext) {
    this.vertex = compiled(gl, gl.VERTEX_SHADER, VERTEX);
    this.parallel = gl.getExtension("KHR_parallel_shader_compile");
  }

  /** The program, or null during compilation; throws the compiler's message. */
  get(pixel: Text): Program | null {
    let pending = this.known.get(pixel.key);
    if (!pending) this.known.set(pixel.key, (pending = this.start(pixel.make())));
    if (pending.error !== null) throw new Error(pending.error);
    return pending.program ?? this.finish(pending);
  }

  private start(pixel: string): Pending {
    const { gl } = this;
    const handle = gl.createProgram();
    const shader = compiled(gl, gl.FRAGMENT_SHADER, pixel);
    gl.attachShader(handle, this.vertex);
    gl.attachShader(handle, shader);
    gl.linkProgram(handle);
    return { handle, shader, error: null, program: null };
  }

  private finish(pending: Pending): Program | null {
    const { gl, parallel } = this;
    const { handle, shader } = pending;
    if (parallel && !gl.getProgramParameter(handle, parallel.COMPLETION_STATUS_KHR)) return null;
    if (!gl.getProgramParameter(handle, gl.LINK_STATUS)) {
      if (gl.isContextLost()) return null;
      const log = gl.getShaderInfoLog(shader) || gl.getProgramInfoLog(handle) || "it does not link";
      pending.error = log.replace(/\0/g, "").trim().split("\n")[0] ?? "";
      throw new Error(pending.error);
    }
    gl.deleteShader(shader);
    return (pending.program = { handle, uniforms: uniformsOf(gl, handle) });
  }
}

function compiled(gl: WebGL2RenderingContext, kind: number, text: string): WebGLShader {
  // The shader is null only if the context is lost, and WebGL ignores null.
  const shader = gl.createShader(kind) as WebGLShader;
  gl.shaderSource(shader, text);
  gl.compileShader(shader);
  return shader;
}

function uniformsOf(gl: WebGL2RenderingContext, handle: WebGLProgram): Map<string, Uniform> {
  const uniforms = new Map<string, Uniform>();
  const count = gl.getProgramParameter(handle, gl.ACTIVE_UNIFORMS) as number;
  for (let index = 0; index < count; ++index) {
    const info = gl.getActiveUniform(handle, index);
    const location = info && gl.getUniformLocation(handle, info.name);
    if (location) uniforms.set(info.name.replace(/\[0\]$/, ""), { location, type: info.type });
  }
  return uniforms;
}

/** Draw one triangle over `size` pixels of a target, or of the canvas for null. */
export function drawPass(
  gl: WebGL2RenderingContext,
  program: Program,
  target: Target | null,
  size: readonly [number, number],
  uniforms: Uniforms,
): void {
  gl.bindFramebuffer(gl.FRAMEBUFFER, target?.frame ?? null);
  gl.viewport(0, 0, size[0], size[1]);
  gl.useProgram(program.handle);
  let unit = 0;
  for (const [name, uniform] of program.uniforms) {
    const value = uniforms[name];
    if (uniform.type === gl.SAMPLER_2D) {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, (value as WebGLTexture | undefined) ?? null);
      gl.uniform1i(uniform.location, unit++);
    } else if (value !== undefined) {
      setUniform(gl, uniform, value as number | boolean | readonly number[]);
    }
  }
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}

function setUniform(
  gl: WebGL2RenderingContext,
  { location, type }: Uniform,
  value: number | boolean | readonly number[],
): void {
  const numbers = typeof value === "object" ? value : [Number(value)];
  if (type === gl.INT || type === gl.BOOL) gl.uniform1i(location, numbers[0] ?? 0);
  else if (type === gl.FLOAT) gl.uniform1fv(location, numbers);
  else if (type === gl.FLOAT_VEC2) gl.uniform2fv(location, numbers);
  else if (type === gl.FLOAT_VEC3) gl.uniform3fv(location, numbers);
  else if (type === gl.FLOAT_VEC4) gl.uniform4fv(location, numbers);
  else if (type === gl.FLOAT_MAT3) gl.uniformMatrix3fv(location, false, numbers);
  else if (type === gl.FLOAT_MAT4) gl.uniformMatrix4fv(location, false, numbers);
}

/** Format of a texture: internal format, channels and number type. */
export interface Format {
  readonly inner: number;
  readonly outer: number;
  readonly type: number;
}

export function formats(gl: WebGL2RenderingContext) {
  return {
    float: { inner: gl.RGBA32F, outer: gl.RGBA, type: gl.FLOAT },
    half: { inner: gl.RGBA16F, outer: gl.RGBA, type: gl.FLOAT },
    bytes: { inner: gl.RGBA8, outer: gl.RGBA, type: gl.UNSIGNED_BYTE },
    single: { inner: gl.R32F, outer: gl.RED, type: gl.FLOAT },
    gray: { inner: gl.R8, outer: gl.RED, type: gl.UNSIGNED_BYTE },
  } satisfies Record<string, Format>;
}

export function makeTexture(
  gl: WebGL2RenderingContext,
  format: Format,
  width: number,
  height: number,
  texels: Float32Array<ArrayBuffer> | Uint8Array<ArrayBuffer> | null = null,
  filter: number = gl.NEAREST,
  wrap: readonly [number, number] = [gl.CLAMP_TO_EDGE, gl.CLAMP_TO_EDGE],
): WebGLTexture {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texImage2D(
    gl.TEXTURE_2D,
    0,
    format.inner,
    width,
    height,
    0,
    format.outer,
    format.type,
    texels,
  );
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, filter);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, filter);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, wrap[0]);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, wrap[1]);
  return texture;
}

export function makeTarget(
  gl: WebGL2RenderingContext,
  layers: readonly Format[],
  width: number,
  height: number,
  filter: number = gl.NEAREST,
): Target {
  const frame = gl.createFramebuffer();
  const textures = layers.map((layer) => makeTexture(gl, layer, width, height, null, filter));
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  textures.forEach((texture, index) => {
    const point = gl.COLOR_ATTACHMENT0 + index;
    gl.framebufferTexture2D(gl.FRAMEBUFFER, point, gl.TEXTURE_2D, texture, 0);
  });
  gl.drawBuffers(textures.map((_, index) => gl.COLOR_ATTACHMENT0 + index));
  return { frame, textures };
}

export function deleteTarget(gl: WebGL2RenderingContext, { frame, textures }: Target): void {
  gl.deleteFramebuffer(frame);
  textures.forEach((texture) => gl.deleteTexture(texture));
}

export function clear(gl: WebGL2RenderingContext, { frame, textures }: Target): void {
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  textures.forEach((_, index) => gl.clearBufferfv(gl.COLOR, index, [0, 0, 0, 0]));
}

/** Pixels of one layer of a target: RGBA, bottom row first. */
export function readPixels(
  gl: WebGL2RenderingContext,
  target: Target,
  layer: number,
  [x, y, width, height]: readonly [number, number, number, number],
): Float32Array<ArrayBuffer> {
  const pixels = new Float32Array(4 * width * height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, target.frame);
  gl.readBuffer(gl.COLOR_ATTACHMENT0 + layer);
  gl.readPixels(x, y, width, height, gl.RGBA, gl.FLOAT, pixels);
  return pixels;
}
