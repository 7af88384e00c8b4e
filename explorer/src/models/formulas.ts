// SPDX-License-Identifier: Apache-2.0
// Formulas of the Oren-Nayar family in float64: the TypeScript version of
// python/mxeon/models/diffuse.py.
//
// Names, arguments and order of operations match the NumPy version; each function handles one
// channel.

import type { Vec3 } from "../data";

const { PI } = Math;
const TINY = 2.2250738585072014e-308; // the smallest normal number

// [Portsmouth2025], Eqs. (10), (15), (29).
export const C1 = 0.5 - 2.0 / (3.0 * PI);
export const C2 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

// G_F / pi in powers of 1 - mu, mu in [0, 1]: [Portsmouth2025], Eq. (14); largest error 6.0e-4.
const FON_G = [0.0571085289, 0.491881867, -0.332181442, 0.0714429953] as const;

/** mu_o, mu_i and the signed s = dot(wo, wi) - mu_o mu_i: [Portsmouth2025], below Eq. (3). */
export function cosines(wo: Vec3, wi: Vec3): [mu_o: number, mu_i: number, s: number] {
  return [Math.min(wo[2], 1.0), Math.min(wi[2], 1.0), wo[0] * wi[0] + wo[1] * wi[1]];
}

/** H(mu) = c1 - G_F(mu) / pi: [Portsmouth2025], Eq. (13); FON loses r A_F H(mu). */
export function fonLoss(mu: number): number {
  const S = Math.sqrt((1.0 - mu) * (1.0 + mu));
  const t = mu / (1.0 + S);
  return mu * t * (C1 - (S * t * (2.0 + S)) / (3.0 * PI)) + (2.0 / PI) * S * Math.atan(t);
}

/** H(mu) with the quartic of [Portsmouth2025], Eq. (14): below 0 where mu < 0.0014. */
export function fonLossApprox(mu: number): number {
  const m = 1.0 - mu;
  const [g1, g2, g3, g4] = FON_G;
  return C1 - m * (g1 + m * (g2 + m * (g3 + m * g4)));
}

/** A_F: [Portsmouth2025], below Eq. (11). */
export function fonAf(roughness: number): number {
  return 1.0 / (1.0 + C1 * roughness);
}

/** rho A_F / pi: [Portsmouth2025], Eq. (10). */
export function fonLambert(rho: number, roughness: number): number {
  return (rho / PI) * fonAf(roughness);
}

/** A_q: [Portsmouth2025], below Eq. (1). */
export function qonAq(sigma: number, constant = 0.33): number {
  return 1.0 - (0.5 * sigma ** 2) / (sigma ** 2 + constant);
}

/** B_q: [Portsmouth2025], below Eq. (1). */
export function qonBq(sigma: number): number {
  return (0.45 * sigma ** 2) / (sigma ** 2 + 0.09);
}

/** D, the divisor in the albedo and the value of EON. */
export function eonDenominator(rho: number, roughness: number): number {
  return 1.0 + C1 * roughness - rho * (roughness * (C1 - C2));
}

/** Weight of H(mu_o) H(mu_i) relative to FON's 1 + r s / t_F: Eq. (19) over Eq. (10). */
export function eonMultipleRatio(rho: number, roughness: number): number {
  const weight = (roughness * (1.0 + C2 * roughness)) / (C1 - C2);
  return (rho * weight) / eonDenominator(rho, roughness);
}

/** value / divisor, or 0 if a divisor >= 0 vanishes: this family has no limit there. */
export function orenNayarQuotient(value: number, divisor: number): number {
  return divisor < TINY ? 0.0 : value / divisor;
}

/** s / t_q: [Portsmouth2025], Eq. (4). */
export function qonQuotient(muO: number, muI: number, s: number): number {
  return orenNayarQuotient(Math.max(s, 0.0), Math.max(muO, muI));
}

/** s / t_F: [Portsmouth2025], Eq. (11). */
export function fonQuotient(muO: number, muI: number, s: number): number {
  return qonQuotient(muO, muI, s) + Math.min(s, 0.0);
}

/** rho / pi A_F (1 + r s / t_F + weight H(mu_o) H(mu_i)): [Portsmouth2025], Eq. (16). */
export function eonBrdfMu(
  muO: number,
  muI: number,
  s: number,
  rho: number,
  roughness: number,
): number {
  const singleScatter = 1.0 + roughness * fonQuotient(muO, muI, s);
  const losses = fonLoss(muO) * fonLoss(muI);
  const multiScatter = eonMultipleRatio(rho, roughness) * losses;
  return fonLambert(rho, roughness) * (singleScatter + multiScatter);
}
