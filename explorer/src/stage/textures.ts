// SPDX-License-Identifier: Apache-2.0
// Textures of surroundings and of documents' images, created on first use.

import type { Texels } from "../data";
import type { Surroundings } from "../state";
import * as gpu from "./gpu";
import { irradianceMap, radianceMap } from "./surroundings";

export class Textures {
  readonly white: WebGLTexture;
  private readonly maps = new Map<string, WebGLTexture>();
  private readonly images = new Map<Texels, WebGLTexture>();
  private readonly format: ReturnType<typeof gpu.formats>;

  constructor(
    private readonly gl: WebGL2RenderingContext,
    private readonly sky: Texels | null,
  ) {
    this.format = gpu.formats(gl);
    this.white = gpu.makeTexture(gl, this.format.bytes, 1, 1, new Uint8Array([255, 255, 255, 255]));
  }

  /**
   * Radiance of the surroundings, or its irradiance over pi, in the layout of MaterialX's shaders.
   */
  surroundings(name: Surroundings, kind: "radiance" | "irradiance"): WebGLTexture {
    const known = this.maps.get(name + kind);
    if (known) return known;
    const { gl, format } = this;
    const radiance = radianceMap(name, this.sky);
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

  /** An image without mipmaps, as on the hosts. */
  image(texels: Texels): WebGLTexture {
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
