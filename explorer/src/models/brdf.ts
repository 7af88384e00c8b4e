// SPDX-License-Identifier: Apache-2.0
// BRDFs of Lambert and the Oren-Nayar family, in 1/sr, without the cosine: the TypeScript version
// of python/mxeon/models/diffuse.py.

import type { Vec3 } from "../data";
import {
  cosines,
  eonBrdfMu,
  eonMultipleRatio,
  fonLossApprox,
  fonQuotient,
  fonLambert,
  orenNayarQuotient,
  qonAq,
  qonBq,
  qonQuotient,
} from "./formulas";

const { PI } = Math;
const TINY = 2.2250738585072014e-308;

/** Value of one channel for a pair of directions; `parameter` is roughness, or sigma in radian. */
export type Brdf = (wo: Vec3, wi: Vec3, rho: number, parameter: number) => number;

/** [Portsmouth2025], section 2.1, the limit sigma -> 0. */
export const lambertBrdf: Brdf = (_wo, _wi, rho) => rho / PI;

/** The angle with sine y and cosine x, as a fraction of a right angle. */
function orenNayarAngle(y: number, x: number): number {
  return (2.0 / PI) * Math.atan2(y, x);
}

/** (sin(alpha) - (2 beta / pi)^3) / cos(beta); its limit is 6 / pi if both directions graze. */
function orenNayarBehindSlope(muO: number, muI: number, S_o: number, S_i: number): number {
  const high = Math.max(muO, muI);
  const low = Math.min(muO, muI);
  const q = orenNayarAngle(high, Math.min(S_o, S_i));
  const rise = q * (3.0 - 3.0 * q + q ** 2) - low ** 2 / (1.0 + Math.max(S_o, S_i));
  return high < TINY ? 6.0 / PI : rise / high;
}

/** Term that interreflection adds to A: [OrenNayar1994], [Fujii2013]. */
function orenNayarInterreflection(rho: number, sigma: number): number {
  return 0.17 * rho * (sigma ** 2 / (sigma ** 2 + 0.13));
}

/** The functional approximation of [OrenNayar1994], with interreflection. */
export const orenNayarBrdf: Brdf = (wo, wi, rho, sigma) => {
  const [muO, muI, s] = cosines(wo, wi);
  const S_o = Math.hypot(wo[0], wo[1]);
  const S_i = Math.hypot(wi[0], wi[1]);
  const elevationO = orenNayarAngle(muO, S_o);
  const elevationI = orenNayarAngle(muI, S_i);
  const alpha = 1.0 - Math.min(elevationO, elevationI);
  const beta = 1.0 - Math.max(elevationO, elevationI);
  const cosPhi = orenNayarQuotient(s, S_o * S_i);
  // C2 cos(phi) tan(beta), where sin(beta) cos(phi) is s / sin(alpha).
  const behind =
    orenNayarQuotient(Math.min(s, 0.0), Math.max(S_o, S_i)) *
    orenNayarBehindSlope(muO, muI, S_o, S_i);
  // C3 and its factors, where 1 - cos(phi)^2 is (cross / (S_o S_i))^2.
  const cross = wo[0] * wi[1] - wo[1] * wi[0];
  const aside =
    (orenNayarQuotient(cross, S_o * S_i) ** 2 / (1.0 + Math.abs(cosPhi))) *
    orenNayarQuotient(S_o + S_i, muO + muI);
  const C3 = (0.125 / 0.45) * qonBq(sigma) * (alpha * beta) ** 2;
  const singleScatter = qonAq(sigma) + qonBq(sigma) * (qonQuotient(muO, muI, s) + behind);
  const interreflection = orenNayarInterreflection(rho, sigma) * (1.0 - beta ** 2 * cosPhi);
  return (rho / PI) * (singleScatter + C3 * aside + interreflection);
};

/** [Portsmouth2025], Eqs. (1), (3), (4). */
export const qonBrdf: Brdf = (wo, wi, rho, sigma) =>
  (rho / PI) * (qonAq(sigma) + qonBq(sigma) * qonQuotient(...cosines(wo, wi)));

/** QON with 0.57 instead of 0.33 in A_q: [Portsmouth2025], footnote 1. */
export const qonFootnoteBrdf: Brdf = (wo, wi, rho, sigma) =>
  (rho / PI) * (qonAq(sigma, 0.57) + qonBq(sigma) * qonQuotient(...cosines(wo, wi)));

/** [Fujii2013], first proposed formula. */
export const qonFujiiBrdf: Brdf = (wo, wi, rho, sigma) => {
  const a = qonAq(sigma) + orenNayarInterreflection(rho, sigma);
  return (rho / PI) * (a + qonBq(sigma) * fonQuotient(...cosines(wo, wi)));
};

/** [Portsmouth2025], Eqs. (10), (11). */
export const fonBrdf: Brdf = (wo, wi, rho, roughness) =>
  fonLambert(rho, roughness) * (1.0 + roughness * fonQuotient(...cosines(wo, wi)));

/** [Portsmouth2025], Eqs. (16), (19). */
export const eonBrdf: Brdf = (wo, wi, rho, roughness) =>
  eonBrdfMu(...cosines(wo, wi), rho, roughness);

/** EON with the quartic for H, clamped at 0 because it is negative for mu < 0.0014. */
export const eonBrdfApprox: Brdf = (wo, wi, rho, roughness) => {
  const [muO, muI, s] = cosines(wo, wi);
  const losses = Math.max(fonLossApprox(muO), 0.0) * Math.max(fonLossApprox(muI), 0.0);
  const singleScatter = 1.0 + roughness * fonQuotient(muO, muI, s);
  const multiScatter = eonMultipleRatio(rho, roughness) * losses;
  return fonLambert(rho, roughness) * (singleScatter + multiScatter);
};
