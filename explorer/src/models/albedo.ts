// SPDX-License-Identifier: Apache-2.0
// Directional albedos by quadrature, for models without a closed form, and the inverse of albedos.

import type { Triple, Vec3 } from "../data";

const { PI } = Math;

/** Value of one channel for a pair of directions; `parameter` is roughness, or sigma in radians. */
export type Brdf = (wo: Vec3, wi: Vec3, rho: number, parameter: number) => number;

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
  // Polar angles and weights. Below theta_o, the angles crowd towards theta_o.
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

/**
 * Argument in [0, 1] where an increasing function has this value, or the nearer end of the
 * interval.
 */
export function bisect(growing: (rho: number) => number, value: number): number {
  if (growing(1.0) <= value) return 1.0;
  if (growing(0.0) >= value) return 0.0;
  let [low, high] = [0.0, 1.0];
  for (let step = 0; step < 48; step++) {
    const middle = 0.5 * (low + high);
    if (growing(middle) < value) low = middle;
    else high = middle;
  }
  return 0.5 * (low + high);
}
