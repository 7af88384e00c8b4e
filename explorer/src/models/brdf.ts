// SPDX-License-Identifier: Apache-2.0
// BRDFs of Lambert and the Oren-Nayar family, in 1/sr, without the cosine: the TypeScript version
// of python/mxeon/models/diffuse.py.

import type { Vec3 } from "../data";
import {
  cosines,
  eon_brdf_mu,
  eon_multiple_ratio,
  fon_loss_approx,
  fon_quotient,
  fon_lambert,
  oren_nayar_quotient,
  qon_aq,
  qon_bq,
  qon_quotient,
} from "./formulas";

const { PI } = Math;
const TINY = 2.2250738585072014e-308;

/** Value of one channel for a pair of directions; `parameter` is roughness, or sigma in radian. */
export type Brdf = (wo: Vec3, wi: Vec3, rho: number, parameter: number) => number;

/** [Portsmouth2025], section 2.1, the limit sigma -> 0. */
export const lambert_brdf: Brdf = (_wo, _wi, rho) => rho / PI;

/** The angle with sine y and cosine x, as a fraction of a right angle. */
function oren_nayar_angle(y: number, x: number): number {
  return (2.0 / PI) * Math.atan2(y, x);
}

/** (sin(alpha) - (2 beta / pi)^3) / cos(beta); its limit is 6 / pi if both directions graze. */
function oren_nayar_behind_slope(mu_o: number, mu_i: number, S_o: number, S_i: number): number {
  const high = Math.max(mu_o, mu_i);
  const low = Math.min(mu_o, mu_i);
  const q = oren_nayar_angle(high, Math.min(S_o, S_i));
  const rise = q * (3.0 - 3.0 * q + q ** 2) - low ** 2 / (1.0 + Math.max(S_o, S_i));
  return high < TINY ? 6.0 / PI : rise / high;
}

/** Term that interreflection adds to A: [OrenNayar1994], [Fujii2013]. */
function oren_nayar_interreflection(rho: number, sigma: number): number {
  return 0.17 * rho * (sigma ** 2 / (sigma ** 2 + 0.13));
}

/** The functional approximation of [OrenNayar1994], with interreflection. */
export const oren_nayar_brdf: Brdf = (wo, wi, rho, sigma) => {
  const [mu_o, mu_i, s] = cosines(wo, wi);
  const S_o = Math.hypot(wo[0], wo[1]);
  const S_i = Math.hypot(wi[0], wi[1]);
  const elevation_o = oren_nayar_angle(mu_o, S_o);
  const elevation_i = oren_nayar_angle(mu_i, S_i);
  const alpha = 1.0 - Math.min(elevation_o, elevation_i);
  const beta = 1.0 - Math.max(elevation_o, elevation_i);
  const cos_phi = oren_nayar_quotient(s, S_o * S_i);
  // C2 cos(phi) tan(beta), where sin(beta) cos(phi) is s / sin(alpha).
  const behind =
    oren_nayar_quotient(Math.min(s, 0.0), Math.max(S_o, S_i)) *
    oren_nayar_behind_slope(mu_o, mu_i, S_o, S_i);
  // C3 and its factors, where 1 - cos(phi)^2 is (cross / (S_o S_i))^2.
  const cross = wo[0] * wi[1] - wo[1] * wi[0];
  const aside =
    (oren_nayar_quotient(cross, S_o * S_i) ** 2 / (1.0 + Math.abs(cos_phi))) *
    oren_nayar_quotient(S_o + S_i, mu_o + mu_i);
  const C3 = (0.125 / 0.45) * qon_bq(sigma) * (alpha * beta) ** 2;
  const single_scatter = qon_aq(sigma) + qon_bq(sigma) * (qon_quotient(mu_o, mu_i, s) + behind);
  const interreflection = oren_nayar_interreflection(rho, sigma) * (1.0 - beta ** 2 * cos_phi);
  return (rho / PI) * (single_scatter + C3 * aside + interreflection);
};

/** [Portsmouth2025], Eqs. (1), (3), (4). */
export const qon_brdf: Brdf = (wo, wi, rho, sigma) =>
  (rho / PI) * (qon_aq(sigma) + qon_bq(sigma) * qon_quotient(...cosines(wo, wi)));

/** QON with 0.57 instead of 0.33 in A_q: [Portsmouth2025], footnote 1. */
export const qon_footnote_brdf: Brdf = (wo, wi, rho, sigma) =>
  (rho / PI) * (qon_aq(sigma, 0.57) + qon_bq(sigma) * qon_quotient(...cosines(wo, wi)));

/** [Fujii2013], first proposed formula. */
export const qon_fujii_brdf: Brdf = (wo, wi, rho, sigma) => {
  const a = qon_aq(sigma) + oren_nayar_interreflection(rho, sigma);
  return (rho / PI) * (a + qon_bq(sigma) * fon_quotient(...cosines(wo, wi)));
};

/** [Portsmouth2025], Eqs. (10), (11). */
export const fon_brdf: Brdf = (wo, wi, rho, roughness) =>
  fon_lambert(rho, roughness) * (1.0 + roughness * fon_quotient(...cosines(wo, wi)));

/** [Portsmouth2025], Eqs. (16), (19). */
export const eon_brdf: Brdf = (wo, wi, rho, roughness) =>
  eon_brdf_mu(...cosines(wo, wi), rho, roughness);

/** EON with the quartic for H, clamped at 0 because it is negative for mu < 0.0014. */
export const eon_brdf_approx: Brdf = (wo, wi, rho, roughness) => {
  const [mu_o, mu_i, s] = cosines(wo, wi);
  const losses = Math.max(fon_loss_approx(mu_o), 0.0) * Math.max(fon_loss_approx(mu_i), 0.0);
  const single_scatter = 1.0 + roughness * fon_quotient(mu_o, mu_i, s);
  const multi_scatter = eon_multiple_ratio(rho, roughness) * losses;
  return fon_lambert(rho, roughness) * (single_scatter + multi_scatter);
};
