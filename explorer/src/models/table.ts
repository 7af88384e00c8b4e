// SPDX-License-Identifier: Apache-2.0
// The table of models and known defects, one row each: the TypeScript version of
// python/mxeon/models/table.py.

import type { ModelName, Vec3 } from "../data";
import * as albedo from "./albedo";
import * as models from "./brdf";
import type { Brdf } from "./brdf";
import { bisect, eon_rho_from_albedo_avg, eon_rho_from_albedo_normal } from "./inversion";
import * as defects from "./known_defects";

export interface Model {
  readonly name: ModelName;
  readonly title: string;
  readonly short: string; // short title
  readonly brdf: Brdf;
  readonly parameter: "roughness" | "sigma" | null;
  readonly albedo_dir: albedo.AlbedoDir | null; // closed form, if known
  readonly albedo_avg: albedo.AlbedoAvg | null;
  /** Only defects: the intended model, and where the defect differs from it. */
  readonly meant: ModelName | null;
  readonly wrong: string;
}

type White = (...of: number[]) => number;

/**
 * Convert `white(..., parameter)`, an albedo at unit reflectance, to a function of rho and the
 * parameter.
 */
function tinted_dir(white: White): albedo.AlbedoDir {
  return (mu, rho, parameter) => rho * white(mu, parameter);
}

function tinted_avg(white: White): albedo.AlbedoAvg {
  return (rho, parameter) => rho * white(parameter);
}

const MODEL = { albedo_dir: null, albedo_avg: null, meant: null, wrong: "" } as const;

export const MODELS: readonly Model[] = [
  {
    ...MODEL,
    name: "eon",
    title: "energy-preserving Oren-Nayar (EON)",
    short: "EON",
    brdf: models.eon_brdf,
    parameter: "roughness",
    albedo_dir: albedo.eon_albedo_dir,
    albedo_avg: albedo.eon_albedo_avg,
  },
  {
    ...MODEL,
    name: "qon",
    title: "qualitative Oren-Nayar (QON)",
    short: "QON",
    brdf: models.qon_brdf,
    parameter: "sigma",
    albedo_dir: tinted_dir(albedo.qon_albedo_dir),
    albedo_avg: tinted_avg(albedo.qon_albedo_avg),
  },
  {
    ...MODEL,
    name: "fon",
    title: "Fujii Oren-Nayar (FON)",
    short: "FON",
    brdf: models.fon_brdf,
    parameter: "roughness",
    albedo_dir: tinted_dir(albedo.fon_albedo_dir),
    albedo_avg: tinted_avg(albedo.fon_albedo_avg),
  },
  {
    ...MODEL,
    name: "lambert",
    title: "Lambert",
    short: "Lambert",
    brdf: models.lambert_brdf,
    parameter: null,
    albedo_dir: (_mu, rho) => rho,
    albedo_avg: (rho) => rho,
  },
  {
    ...MODEL,
    name: "oren_nayar",
    title: "full Oren-Nayar",
    short: "full Oren-Nayar",
    brdf: models.oren_nayar_brdf,
    parameter: "sigma",
  },
  {
    ...MODEL,
    name: "qon_footnote",
    title: "QON with the footnote's constant",
    short: "QON, footnote",
    brdf: models.qon_footnote_brdf,
    parameter: "sigma",
  },
  {
    ...MODEL,
    name: "qon_fujii",
    title: "QON with Fujii's coefficients",
    short: "QON, Fujii",
    brdf: models.qon_fujii_brdf,
    parameter: "sigma",
  },
  {
    ...MODEL,
    name: "eon_approx",
    title: "EON with the paper's quartic",
    short: "EON, quartic",
    brdf: models.eon_brdf_approx,
    parameter: "roughness",
  },
];

export const KNOWN_DEFECTS: readonly Model[] = [
  {
    ...MODEL,
    name: "eon_clamped",
    title: "EON with clamped dot(wo, wi)",
    short: "EON, clamped",
    brdf: defects.eon_clamped_brdf,
    parameter: "roughness",
    meant: "eon",
    wrong: "too bright where the light comes from behind, dot(wo, wi) < 0",
  },
  {
    ...MODEL,
    name: "eon_rho_cubed",
    title: "EON with rho^3",
    short: "EON, rho^3",
    brdf: defects.eon_rho_cubed_brdf,
    parameter: "roughness",
    albedo_dir: defects.eon_rho_cubed_albedo_dir,
    meant: "eon",
    wrong: "too dark where the color is neither 0 nor 1",
  },
  {
    ...MODEL,
    name: "fon_white_lobe",
    title: "FON + white lobe",
    short: "FON + white",
    brdf: defects.fon_white_lobe_brdf,
    parameter: "roughness",
    albedo_dir: defects.fon_white_lobe_albedo_dir,
    meant: "eon",
    wrong: "too bright wherever the color is below 1; black reflects light",
  },
  {
    ...MODEL,
    name: "qon_fitted",
    title: "QON with MaterialX's fit of its albedo",
    short: "QON, fitted albedo",
    brdf: models.qon_brdf,
    parameter: "sigma",
    albedo_dir: defects.qon_fitted_albedo_dir,
    meant: "qon",
    wrong: "wrong in surroundings only: the albedo is off by up to 0.063",
  },
  {
    ...MODEL,
    name: "qon_tinted_twice",
    title: "QON tinted twice",
    short: "QON, tinted twice",
    brdf: defects.qon_tinted_twice_brdf,
    parameter: "sigma",
    albedo_dir: defects.qon_tinted_twice_albedo_dir,
    meant: "qon",
    wrong: "too dark where the color is neither 0 nor 1",
  },
];

const ROWS = new Map([...MODELS, ...KNOWN_DEFECTS].map((row) => [row.name, row]));

/** The row of `MODELS` or `KNOWN_DEFECTS` with this name. */
export function model(name: ModelName): Model {
  return ROWS.get(name)!;
}

/** pi f cos(theta_i) of one channel; 0 if the light is below the horizon. */
export function pi_f_cos(of: Model, wo: Vec3, wi: Vec3, rho: number, parameter: number): number {
  return wi[2] <= 0.0 ? 0.0 : Math.PI * of.brdf(wo, wi, rho, parameter) * wi[2];
}

/** Directional albedo, in closed form if there is one, else by quadrature with `nodes`. */
export function albedo_dir(
  of: Model,
  mu: number,
  rho: number,
  parameter: number,
  nodes = 64,
): number {
  if (of.albedo_dir) return of.albedo_dir(mu, rho, parameter);
  return albedo.albedo_dir_quadrature(of.brdf, mu, rho, parameter, nodes);
}

/** Average albedo, 2 times the integral of mu E(mu): in closed form, or by Simpson's rule. */
export function albedo_avg(of: Model, rho: number, parameter: number): number {
  if (of.albedo_avg) return of.albedo_avg(rho, parameter);
  const steps = 16;
  let sum = 0.0;
  for (let k = 0; k <= steps; k++) {
    const mu = k / steps;
    const weight = k === 0 || k === steps ? 1 : 2 + 2 * (k % 2);
    sum += (weight / (3 * steps)) * 2.0 * mu * albedo_dir(of, mu, rho, parameter, 16);
  }
  return sum;
}

/** Color to enter for one channel to have this albedo, at normal incidence or on average. */
export function rho_from_albedo(
  of: Model,
  seen: number,
  parameter: number,
  average: boolean,
): number {
  if (of.name === "eon") {
    return (average ? eon_rho_from_albedo_avg : eon_rho_from_albedo_normal)(seen, parameter);
  }
  const albedo_of = (rho: number): number =>
    average ? albedo_avg(of, rho, parameter) : albedo_dir(of, 1.0, rho, parameter, 16);
  return bisect(albedo_of, seen);
}
