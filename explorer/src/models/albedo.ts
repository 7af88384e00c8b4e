// SPDX-License-Identifier: Apache-2.0
// Directional and average albedos: the TypeScript version of python/mxeon/models/diffuse.py, and of
// quadrature.py for models without a closed form.

import type { Triple } from "../data";
import type { Brdf } from "./brdf";
import { C1, C2, eon_denominator, fon_af, fon_loss, qon_aq, qon_bq } from "./formulas";

const { PI } = Math;

/** Directional albedo of one channel; `parameter` is roughness, or sigma in radian. */
export type AlbedoDir = (mu: number, rho: number, parameter: number) => number;
/** Average albedo of one channel. */
export type AlbedoAvg = (rho: number, parameter: number) => number;

/** Directional albedo of QON at unit reflectance: [Portsmouth2025], Eqs. (5), (8). */
export function qon_albedo_dir(mu: number, sigma: number): number {
  const g_over_pi = C1 - fon_loss(mu) + (2.0 / (3.0 * PI)) * Math.sqrt((1.0 - mu) * (1.0 + mu));
  return qon_aq(sigma) + qon_bq(sigma) * g_over_pi;
}

/** Average albedo of QON at unit reflectance: [Portsmouth2025], Eq. (9). */
export function qon_albedo_avg(sigma: number): number {
  return qon_aq(sigma) + (2.0 / 3.0 - 64.0 / (45.0 * PI)) * qon_bq(sigma);
}

/** Directional albedo of FON at unit reflectance: [Portsmouth2025], Eqs. (12), (13). */
export function fon_albedo_dir(mu: number, roughness: number): number {
  return 1.0 - roughness * fon_loss(mu) * fon_af(roughness);
}

/** Average albedo of FON at unit reflectance: [Portsmouth2025], Eqs. (15), (29). */
export function fon_albedo_avg(roughness: number): number {
  return (1.0 + C2 * roughness) * fon_af(roughness);
}

/** Directional albedo of EON: [Portsmouth2025], Eq. (28). */
export const eon_albedo_dir: AlbedoDir = (mu, rho, roughness) =>
  eon_albedo(fon_loss(mu), rho, roughness);

/** Average albedo of EON: [Portsmouth2025], Eqs. (15), (28), averaged. */
export const eon_albedo_avg: AlbedoAvg = (rho, roughness) => eon_albedo(C1 - C2, rho, roughness);

/** Albedo of EON where FON loses r A loss. */
function eon_albedo(loss: number, rho: number, r: number): number {
  return rho * (1.0 - ((1.0 - rho) * r * loss) / eon_denominator(rho, r));
}

/**
 * Directional albedo of a model symmetric about the plane of incidence, by Gauss-Legendre rules.
 */
export function albedo_dir_quadrature(
  brdf: Brdf,
  mu: number,
  rho: number,
  parameter: number,
  nodes = 64,
): number {
  const [x, weight] = unit_interval_rule(nodes);
  const theta_o = Math.acos(mu);
  const rest = PI / 2.0 - theta_o;
  const wo: Triple = [Math.sqrt((1.0 - mu) * (1.0 + mu)), 0.0, mu];
  // Polar angles and weights: below theta_o, where the nodes crowd, and above it.
  const polar: [number, number][] = [
    ...x.map((u, k): [number, number] => [
      theta_o * (1.0 - u ** 5),
      theta_o * 5.0 * u ** 4 * weight[k]!,
    ]),
    ...x.map((u, k): [number, number] => [theta_o + rest * u, rest * weight[k]!]),
  ];
  let sum = 0.0;
  for (const [theta, d_theta] of polar) {
    const [sine, z] = [Math.sin(theta), Math.cos(theta)];
    for (let half = 0; half < 2; half++) {
      for (let k = 0; k < nodes; k++) {
        const phi = (PI / 2.0) * (half + x[k]!);
        const wi: Triple = [sine * Math.cos(phi), sine * Math.sin(phi), z];
        const d_phi = (PI / 2.0) * weight[k]!;
        sum += 2.0 * d_theta * d_phi * sine * z * brdf(wo, wi, rho, parameter);
      }
    }
  }
  return sum;
}

const rules = new Map<number, [number[], number[]]>();

/** Nodes and weights of Gauss-Legendre on [0, 1], by Newton's method on the polynomial. */
function unit_interval_rule(nodes: number): [number[], number[]] {
  const known = rules.get(nodes);
  if (known) return known;
  const x: number[] = [];
  const weight: number[] = [];
  for (let k = nodes; k >= 1; k--) {
    let root = Math.cos((PI * (k - 0.25)) / (nodes + 0.5));
    let slope = 0.0;
    for (let step = 0; step < 8; step++) {
      let [value, before] = [1.0, 0.0];
      for (let n = 1; n <= nodes; n++) {
        [value, before] = [((2 * n - 1) * root * value - (n - 1) * before) / n, value];
      }
      slope = (nodes * (root * value - before)) / (root * root - 1.0);
      root -= value / slope;
    }
    x.push(0.5 * (1.0 + root));
    weight.push(1.0 / ((1.0 - root * root) * slope * slope));
  }
  rules.set(nodes, [x, weight]);
  return [x, weight];
}
