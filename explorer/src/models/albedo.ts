// SPDX-License-Identifier: Apache-2.0
// Directional and average albedos: the TypeScript version of python/mxeon/models/diffuse.py, and of
// quadrature.py for models without a closed form.

import type { Triple } from "../data";
import type { Brdf } from "./brdf";
import { C1, C2, eonDenominator, fonAf, fonLoss, qonAq, qonBq } from "./formulas";

const { PI } = Math;

/** Directional albedo of one channel; `parameter` is roughness, or sigma in radian. */
export type AlbedoDir = (mu: number, rho: number, parameter: number) => number;
/** Average albedo of one channel. */
export type AlbedoAvg = (rho: number, parameter: number) => number;

/** Directional albedo of QON at unit reflectance: [Portsmouth2025], Eqs. (5), (8). */
export function qonAlbedoDir(mu: number, sigma: number): number {
  const gOverPi = C1 - fonLoss(mu) + (2.0 / (3.0 * PI)) * Math.sqrt((1.0 - mu) * (1.0 + mu));
  return qonAq(sigma) + qonBq(sigma) * gOverPi;
}

/** Average albedo of QON at unit reflectance: [Portsmouth2025], Eq. (9). */
export function qonAlbedoAvg(sigma: number): number {
  return qonAq(sigma) + (2.0 / 3.0 - 64.0 / (45.0 * PI)) * qonBq(sigma);
}

/** Directional albedo of FON at unit reflectance: [Portsmouth2025], Eqs. (12), (13). */
export function fonAlbedoDir(mu: number, roughness: number): number {
  return 1.0 - roughness * fonLoss(mu) * fonAf(roughness);
}

/** Average albedo of FON at unit reflectance: [Portsmouth2025], Eqs. (15), (29). */
export function fonAlbedoAvg(roughness: number): number {
  return (1.0 + C2 * roughness) * fonAf(roughness);
}

/** Directional albedo of EON: [Portsmouth2025], Eq. (28). */
export const eonAlbedoDir: AlbedoDir = (mu, rho, roughness) =>
  eonAlbedo(fonLoss(mu), rho, roughness);

/** Average albedo of EON: [Portsmouth2025], Eqs. (15), (28), averaged. */
export const eonAlbedoAvg: AlbedoAvg = (rho, roughness) => eonAlbedo(C1 - C2, rho, roughness);

/** Albedo of EON where FON loses r A loss. */
function eonAlbedo(loss: number, rho: number, r: number): number {
  return rho * (1.0 - ((1.0 - rho) * r * loss) / eonDenominator(rho, r));
}

/**
 * Directional albedo of a model symmetric about the plane of incidence, by Gauss-Legendre rules.
 */
export function albedoDirQuadrature(
  brdf: Brdf,
  mu: number,
  rho: number,
  parameter: number,
  nodes = 64,
): number {
  const [x, weight] = unitIntervalRule(nodes);
  const thetaO = Math.acos(mu);
  const rest = PI / 2.0 - thetaO;
  const wo: Triple = [Math.sqrt((1.0 - mu) * (1.0 + mu)), 0.0, mu];
  // Polar angles and weights: below theta_o, where the nodes crowd, and above it.
  const polar: [number, number][] = [
    ...x.map((u, k): [number, number] => [
      thetaO * (1.0 - u ** 5),
      thetaO * 5.0 * u ** 4 * weight[k]!,
    ]),
    ...x.map((u, k): [number, number] => [thetaO + rest * u, rest * weight[k]!]),
  ];
  let sum = 0.0;
  for (const [theta, dTheta] of polar) {
    const [sine, z] = [Math.sin(theta), Math.cos(theta)];
    for (let half = 0; half < 2; half++) {
      for (let k = 0; k < nodes; k++) {
        const phi = (PI / 2.0) * (half + x[k]!);
        const wi: Triple = [sine * Math.cos(phi), sine * Math.sin(phi), z];
        const dPhi = (PI / 2.0) * weight[k]!;
        sum += 2.0 * dTheta * dPhi * sine * z * brdf(wo, wi, rho, parameter);
      }
    }
  }
  return sum;
}

const rules = new Map<number, [number[], number[]]>();

/** Nodes and weights of Gauss-Legendre on [0, 1], by Newton's method on the polynomial. */
function unitIntervalRule(nodes: number): [number[], number[]] {
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
