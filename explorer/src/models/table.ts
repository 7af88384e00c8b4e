// SPDX-License-Identifier: Apache-2.0
// The same models and known defects as in python/mxeon/models/table.py. Functions are translated
// from the GLSL of the page to float64.

import * as glsl from "glsl:models";
import type { Vec3 } from "../data";
import { albedoDirQuadrature, bisect, type Brdf } from "./albedo";

/** Directional albedo of one channel; `parameter` is roughness, or sigma in radians. */
type AlbedoDir = (mu: number, rho: number, parameter: number) => number;
/** Average albedo of one channel. */
type AlbedoAvg = (rho: number, parameter: number) => number;

export interface Model {
  readonly name: string;
  readonly title: string;
  readonly short: string; // short title
  readonly brdf: Brdf;
  readonly parameter: "roughness" | "sigma" | null;
  readonly albedoDir?: AlbedoDir; // closed form, if known
  readonly albedoAvg?: AlbedoAvg;
  /** For defects only: the intended model, and where the defect differs from that model. */
  readonly meant?: string;
  readonly wrong?: string;
}

type White = (...of: number[]) => number;

/**
 * Convert `white(..., parameter)`, an albedo at unit reflectance, to a function of rho and the
 * parameter.
 */
function tintedDir(white: White): AlbedoDir {
  return (mu, rho, parameter) => rho * white(mu, parameter);
}

function tintedAvg(white: White): AlbedoAvg {
  return (rho, parameter) => rho * white(parameter);
}

const DARK = "too dark where the color is neither 0 nor 1";

const ROWS = [
  {
    name: "eon",
    title: "energy-preserving Oren-Nayar (EON)",
    short: "EON",
    brdf: glsl.eon_brdf,
    parameter: "roughness",
    albedoDir: glsl.eon_albedo_dir,
    albedoAvg: glsl.eon_albedo_avg,
  },
  {
    name: "qon",
    title: "qualitative Oren-Nayar (QON)",
    short: "QON",
    brdf: glsl.qon_brdf,
    parameter: "sigma",
    albedoDir: tintedDir(glsl.qon_albedo_dir),
    albedoAvg: tintedAvg(glsl.qon_albedo_avg),
  },
  {
    name: "fon",
    title: "Fujii Oren-Nayar (FON)",
    short: "FON",
    brdf: glsl.fon_brdf,
    parameter: "roughness",
    albedoDir: tintedDir(glsl.fon_albedo_dir),
    albedoAvg: tintedAvg(glsl.fon_albedo_avg),
  },
  {
    name: "lambert",
    title: "Lambert",
    short: "Lambert",
    brdf: glsl.lambert_brdf,
    parameter: null,
    albedoDir: (_mu, rho) => rho,
    albedoAvg: (rho) => rho,
  },
  {
    name: "oren_nayar",
    title: "full Oren-Nayar",
    short: "full Oren-Nayar",
    brdf: glsl.oren_nayar_brdf,
    parameter: "sigma",
  },
  {
    name: "qon_footnote",
    title: "QON with the footnote's constant",
    short: "QON, footnote",
    brdf: glsl.qon_footnote_brdf,
    parameter: "sigma",
  },
  {
    name: "qon_fujii",
    title: "QON with Fujii's coefficients",
    short: "QON, Fujii",
    brdf: glsl.qon_fujii_brdf,
    parameter: "sigma",
  },
  {
    name: "eon_approx",
    title: "EON with the paper's quartic",
    short: "EON, quartic",
    brdf: glsl.eon_brdf_approx,
    parameter: "roughness",
  },
  // Known defects.
  {
    name: "eon_clamped",
    title: "EON with clamped dot(wo, wi)",
    short: "EON, clamped",
    brdf: glsl.eon_clamped_brdf,
    parameter: "roughness",
    meant: "eon",
    wrong: "too bright where the light comes from behind, dot(wo, wi) < 0",
  },
  {
    name: "eon_rho_cubed",
    title: "EON with rho^3",
    short: "EON, rho^3",
    brdf: glsl.eon_rho_cubed_brdf,
    parameter: "roughness",
    albedoDir: glsl.eon_rho_cubed_albedo_dir,
    meant: "eon",
    wrong: DARK,
  },
  {
    name: "fon_white_lobe",
    title: "FON + white lobe",
    short: "FON + white",
    brdf: glsl.fon_white_lobe_brdf,
    parameter: "roughness",
    albedoDir: glsl.fon_white_lobe_albedo_dir,
    meant: "eon",
    wrong: "too bright wherever the color is below 1; black reflects light",
  },
  {
    name: "qon_fitted",
    title: "QON with MaterialX's fit of its albedo",
    short: "QON, fitted albedo",
    brdf: glsl.qon_brdf,
    parameter: "sigma",
    albedoDir: glsl.qon_fitted_albedo_dir,
    meant: "qon",
    wrong: "wrong in an environment only: the albedo has an error up to 0.063",
  },
  {
    name: "qon_tinted_twice",
    title: "QON tinted twice",
    short: "QON, tinted twice",
    brdf: glsl.qon_tinted_twice_brdf,
    parameter: "sigma",
    albedoDir: glsl.qon_tinted_twice_albedo_dir,
    meant: "qon",
    wrong: DARK,
  },
] as const satisfies readonly Model[];

export type ModelName = (typeof ROWS)[number]["name"];

const NAMED = new Map<ModelName, Model>(ROWS.map((row) => [row.name, row]));

/** The row of a model or known defect. */
export function model(name: ModelName): Model {
  return NAMED.get(name)!;
}

/** pi f cos(theta_i) of one channel; 0 if the light is below the horizon. */
export function piFCos(of: Model, wo: Vec3, wi: Vec3, rho: number, parameter: number): number {
  return wi[2] <= 0.0 ? 0.0 : Math.PI * of.brdf(wo, wi, rho, parameter) * wi[2];
}

/** Directional albedo, in closed form if known, otherwise by quadrature with `nodes`. */
export function albedoDir(
  of: Model,
  mu: number,
  rho: number,
  parameter: number,
  nodes = 64,
): number {
  if (of.albedoDir) return of.albedoDir(mu, rho, parameter);
  return albedoDirQuadrature(of.brdf, mu, rho, parameter, nodes);
}

/** Average albedo, 2 times the integral of mu E(mu): in closed form, or by Simpson's rule. */
export function albedoAvg(of: Model, rho: number, parameter: number): number {
  if (of.albedoAvg) return of.albedoAvg(rho, parameter);
  const steps = 16;
  let sum = 0.0;
  for (let k = 0; k <= steps; k++) {
    const mu = k / steps;
    const weight = k === 0 || k === steps ? 1 : 2 + 2 * (k % 2);
    sum += (weight / (3 * steps)) * 2.0 * mu * albedoDir(of, mu, rho, parameter, 16);
  }
  return sum;
}

/** Color of one channel for a wanted albedo, at normal incidence or on average. */
export function rhoFromAlbedo(
  of: Model,
  seen: number,
  parameter: number,
  average: boolean,
): number {
  const albedoOf = (rho: number): number =>
    average ? albedoAvg(of, rho, parameter) : albedoDir(of, 1.0, rho, parameter, 16);
  return bisect(albedoOf, seen);
}
