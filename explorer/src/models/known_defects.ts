// SPDX-License-Identifier: Apache-2.0
// Wrong variants of EON and QON in renderers: the TypeScript version of
// python/mxeon/models/diffuse.py.

import { eon_albedo_dir, fon_albedo_dir, qon_albedo_dir, type AlbedoDir } from "./albedo";
import { fon_brdf, qon_brdf, type Brdf } from "./brdf";
import {
  C1,
  C2,
  cosines,
  eon_brdf_mu,
  eon_multiple_ratio,
  fon_af,
  fon_loss,
  fon_quotient,
  fon_lambert,
} from "./formulas";

/** EON that clamps dot(wo, wi) to at least 1e-8 before it computes s. */
export const eon_clamped_brdf: Brdf = (wo, wi, rho, roughness) => {
  const [mu_o, mu_i, signed] = cosines(wo, wi);
  const s = Math.max(signed + mu_o * mu_i, 1e-8) - mu_o * mu_i;
  return eon_brdf_mu(mu_o, mu_i, s, rho, roughness);
};

/** EON whose multiple-scattering lobe has rho^3 instead of rho^2. */
export const eon_rho_cubed_brdf: Brdf = (wo, wi, rho, roughness) => {
  const [mu_o, mu_i, s] = cosines(wo, wi);
  const single_scatter = 1.0 + roughness * fon_quotient(mu_o, mu_i, s);
  const weight = rho * eon_multiple_ratio(rho, roughness);
  const multi_scatter = weight * (fon_loss(mu_o) * fon_loss(mu_i));
  return fon_lambert(rho, roughness) * (single_scatter + multi_scatter);
};

/** FON plus the multiple-scattering lobe of a white surface. */
export const fon_white_lobe_brdf: Brdf = (wo, wi, rho, roughness) => {
  const [mu_o, mu_i] = cosines(wo, wi);
  const losses = fon_loss(mu_o) * fon_loss(mu_i);
  const white = ((roughness * fon_af(roughness)) / (Math.PI * (C1 - C2))) * losses;
  return fon_brdf(wo, wi, rho, roughness) + white;
};

/** QON multiplied by its own color a second time. */
export const qon_tinted_twice_brdf: Brdf = (wo, wi, rho, sigma) =>
  rho * qon_brdf(wo, wi, rho, sigma);

/** Directional albedo of `eon_rho_cubed_brdf`: rho (E_EON + (1 - rho) E_FON). */
export const eon_rho_cubed_albedo_dir: AlbedoDir = (mu, rho, roughness) =>
  rho * (eon_albedo_dir(mu, rho, roughness) + (1.0 - rho) * fon_albedo_dir(mu, roughness));

/** Directional albedo of `fon_white_lobe_brdf`: 1 - (1 - rho) E_FON. */
export const fon_white_lobe_albedo_dir: AlbedoDir = (mu, rho, roughness) =>
  1.0 - (1.0 - rho) * fon_albedo_dir(mu, roughness);

/** Directional albedo of `qon_tinted_twice_brdf`. */
export const qon_tinted_twice_albedo_dir: AlbedoDir = (mu, rho, sigma) =>
  rho * rho * qon_albedo_dir(mu, sigma);

/**
 * Directional albedo of QON according to the fit in MaterialX 1.39.5; off by up to 0.068 at rho 1.
 */
export const qon_fitted_albedo_dir: AlbedoDir = (mu, rho, sigma) => {
  const over = 1.0 - 0.4297 * sigma - 0.7632 * mu * sigma + 1.4385 * sigma ** 2;
  const under = 1.0 - 0.6076 * sigma - 0.4993 * mu * sigma + 2.0315 * sigma ** 2;
  return Math.min(over / under, 1.0) * rho;
};
