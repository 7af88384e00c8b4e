// SPDX-License-Identifier: Apache-2.0
// Types of the data that Python embeds in the page (python/mxeon/explorer/data.py writes them).

import type { ModelName } from "./models/table";

export type Vec3 = readonly [number, number, number];
export type Triple = [number, number, number];

/** A node's models with energy_compensation true and false; equal for nodes without this flag. */
interface Models {
  readonly on: ModelName;
  readonly off: ModelName;
}

/** A material with a single model, drawn with `PageData.functions` or with a variant. */
export interface ModelSource {
  readonly kind: "model";
  readonly id: string; // "model/eon"
  readonly title: string; // "energy-preserving Oren-Nayar (EON)"
  readonly group: string; // heading in the selection list
  readonly model: ModelName;
  // The intended model, which differs from `model` for a variant of a renderer.
  readonly meant: ModelName;
  readonly pages: readonly string[]; // names of the pages about defects
}

/** A public input of a generated shader. */
export interface Port {
  readonly name: string; // name of the uniform
  // Type in MaterialX: float, integer, boolean, color3, vector2, filename, ...
  readonly type: string;
  readonly value: number | boolean | readonly number[] | null; // null for a filename
  readonly path: string; // name path of the input in the document
  readonly label: string; // uiname, or the name split into words
  readonly min: number | null; // uimin or uisoftmin; the first component for vectors
  readonly max: number | null;
  readonly image: Texels | null; // null unless the type is filename
  readonly shown: boolean; // whether readers may want to change the input
}

/** An image in base64, RGBA: texels have 8 bits per channel, from the bottom row (v = 0) up. */
export interface Texels {
  readonly width: number;
  readonly height: number;
  readonly rgba: string;
}

/** A material as a shader that mxeon generated, ESSL 3.00, with MaterialX's directional light. */
export interface ShaderSource {
  readonly kind: "shader";
  readonly id: string; // "shader/eonlib", "shader/stock", "document/0/clay/eonlib", ...
  readonly title: string;
  readonly group: string;
  readonly library: string; // "eonlib", "stock"
  readonly pixel: string;
  readonly paths: string; // GLSL for path tracers, or ""
  readonly inputs: readonly Port[];
  /** Uniforms that the page's own controls set; "" for missing uniforms. */
  readonly controls: { readonly color: string; readonly roughness: string; readonly flag: string };
  readonly meant: Models | null; // intended models of one rough diffuse node, otherwise null
  readonly actual: Models | null; // the model of this library's code, according to the diagnosis
  readonly document: string; // MaterialX text for the copy button
  readonly pages: readonly string[]; // names of the pages about defects
  readonly reference: ReferenceTable | null; // null if no model covers all lobes
  readonly checked: Checked | null; // null if the check did not run
}

/** Result of `mxeon check` for a material: its pictures on gl compared with the reference. */
interface Checked {
  readonly kind: "correct" | "within" | "wrong" | "differs" | "unknown";
  readonly text: string;
}

/** Float64 values of the reference models for a material with its own inputs. */
export interface ReferenceTable {
  readonly direct: readonly number[]; // pi f cos(theta_i), 3 channels per pair of PageData.pairs
  // Light reflected in white surroundings, three channels for each of PageData.views.
  readonly white: readonly number[];
  readonly bounds: { readonly direct: number; readonly white: number }; // tolerances for shaders
  readonly forms: readonly ShaderForm[]; // other functions that shaders may implement
}

/**
 * Another function that a shader may implement; values have the same layout as in ReferenceTable.
 */
export interface ShaderForm {
  readonly title: string;
  readonly permitted: boolean; // whether the specification permits the form
  readonly direct: readonly number[];
  readonly white: readonly number[];
}

export type Source = ModelSource | ShaderSource;

export interface PageData {
  readonly version: string; // version of mxeon
  readonly materialx: string;
  /**
   * GLSL functions of eonlib's diffuse models and their samplers, with includes expanded and no
   * #version.
   */
  readonly functions: string;
  readonly sources: readonly Source[];
  /** Pairs of directions (wo and wi) and views of all references, in the local frame. */
  readonly pairs: readonly (readonly [Vec3, Vec3])[];
  readonly views: readonly Vec3[];
  /** URL of the pages about defects, with {} for the name; "" if there is none. */
  readonly pages: string;
  /** Whether `mxeon explore` serves the page, so that dropped files can be shown. */
  readonly served: boolean;
  readonly warnings: readonly string[]; // warnings about the page's documents
  /** The reader's own environment map, in MaterialX's layout: 32-bit floats, top row first. */
  readonly sky: Texels | null;
}
