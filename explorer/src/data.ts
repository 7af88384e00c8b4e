// SPDX-License-Identifier: Apache-2.0
// Types of the data that Python embeds in the page (python/mxeon/explorer/data.py writes them).

export type Vec3 = readonly [number, number, number];
export type Triple = [number, number, number];

/** Name of a row of the tables of models and of known defects, as in python/mxeon/models/table.py. */
export type ModelName =
  | "lambert"
  | "oren_nayar"
  | "qon"
  | "qon_footnote"
  | "qon_fujii"
  | "fon"
  | "eon"
  | "eon_approx"
  | "eon_clamped"
  | "eon_rho_cubed"
  | "fon_white_lobe"
  | "qon_fitted"
  | "qon_tinted_twice";

/** The models that a node has with energy_compensation true and false; equal where it has no flag. */
export interface Models {
  readonly on: ModelName;
  readonly off: ModelName;
}

/** A material that is one model, drawn with the functions of `PageData.functions` or a variant. */
export interface ModelSource {
  readonly kind: "model";
  readonly id: string; // "model/eon"
  readonly title: string; // "energy-preserving Oren-Nayar (EON)"
  readonly group: string; // heading of the list it is chosen from
  readonly model: ModelName;
  readonly meant: ModelName; // what it should be: `model` itself, but for a renderer's variant
  readonly note: string; // one sentence: what it is, or who implements it; "" for none
  readonly pages: readonly string[]; // names of the pages on its defects
}

/** A public input of a generated shader. */
export interface Port {
  readonly name: string; // of the uniform
  readonly type: string; // MaterialX's: float, integer, boolean, color3, vector2, filename, ...
  readonly value: number | boolean | readonly number[] | null; // null of a filename
  readonly path: string; // name path of the input in the document
  readonly label: string; // uiname, or the words of the name
  readonly min: number | null; // uimin, or uisoftmin; per component the least
  readonly max: number | null;
  readonly image: Texels | null; // of a filename
  readonly shown: boolean; // whether readers may want to move it
}

/** An image: RGBA, 8 bits each, row 0 first in v (at the bottom), in base64. */
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
  readonly note: string;
  readonly library: string; // "eonlib", "stock"
  readonly pixel: string;
  readonly paths: string; // the same for a path tracer; "" where there is none
  readonly inputs: readonly Port[];
  /** Uniforms that the page's own controls set, "" where it has none. */
  readonly controls: { readonly color: string; readonly roughness: string; readonly flag: string };
  readonly meant: Models | null; // what the node has to be; null if it is not one diffuse node
  readonly actual: Models | null; // what this library's code is, as the diagnosis names it
  readonly document: string; // its MaterialX text, for the copy button
  readonly pages: readonly string[]; // as those of a ModelSource
  readonly reference: ReferenceTable | null; // null where no model covers all of its lobes
  readonly checked: Checked | null; // null where it did not run
}

/** What `mxeon check` finds of a material: its pictures on gl, against those of the reference. */
export interface Checked {
  readonly kind: "correct" | "wrong" | "differs" | "unknown";
  readonly text: string;
}

/** What the models make of a material with its own inputs, in float64. */
export interface ReferenceTable {
  readonly direct: readonly number[]; // pi f cos(theta_i) for PageData.pairs, 3 each
  readonly white: readonly number[]; // light returned of white surroundings, for PageData.views, 3 each
  readonly bounds: { readonly direct: number; readonly white: number }; // errors that a shader may have
  readonly forms: readonly ShaderForm[]; // what shaders have in its place
}

/** Another function that a shader may have; its values as those of a ReferenceTable, or none. */
export interface ShaderForm {
  readonly title: string;
  readonly permitted: boolean; // the specification leaves it open
  readonly direct: readonly number[];
  readonly white: readonly number[];
}

export type Source = ModelSource | ShaderSource;

/** A picture for browsers without WebGL2. */
export interface Still {
  readonly title: string;
  readonly picture: string; // data: address of a PNG
}

/** A map of longitude and latitude as MaterialX's: RGBA, 32-bit floats, row 0 upwards, in base64. */
export interface Sky {
  readonly width: number;
  readonly height: number; // a multiple of 32
  readonly rgba: string;
}

export interface PageData {
  readonly version: string; // of mxeon
  readonly materialx: string;
  /** eonlib's GLSL functions of the whole family and its samplers, includes expanded, no #version. */
  readonly functions: string;
  readonly sources: readonly Source[];
  /** Pairs of directions, wo and wi of each, and views, in the local frame, of every reference. */
  readonly pairs: readonly (readonly [Vec3, Vec3])[];
  readonly views: readonly Vec3[];
  /** Address of a page on a defect, {} for its name; "" where there is none. */
  readonly pages: string;
  readonly stills: readonly Still[];
  /** Whether `mxeon explore` serves the page, and so shows files that are dropped on it. */
  readonly served: boolean;
  readonly warnings: readonly string[]; // of its documents
  readonly sky: Sky | null; // the reader's own surroundings
}
