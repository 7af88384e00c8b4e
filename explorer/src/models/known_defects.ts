// SPDX-License-Identifier: Apache-2.0
// Wrong variants of EON and QON in renderers: the TypeScript version of
// python/mxeon/models/diffuse.py.

import { eonAlbedoDir, fonAlbedoDir, qonAlbedoDir, type AlbedoDir } from "./albedo";
import { fonBrdf, qonBrdf, type Brdf } from "./brdf";
import {
  C1,
  C2,
  cosines,
  eonBrdfMu,
  eonMultipleRatio,
  fonAf,
  fonLoss,
  fonQuotient,
  fonLambert,
} from "./formulas";

/** EON that clamps dot(wo, wi) to at least 1e-8 before it computes s. */
export const eonClampedBrdf: Brdf = (wo, wi, rho, roughness) => {
  const [muO, muI, signed] = cosines(wo, wi);
  const s = Math.max(signed + muO * muI, 1e-8) - muO * muI;
  return eonBrdfMu(muO, muI, s, rho, roughness);
};

/** EON whose multiple-scattering lobe has rho^3 instead of rho^2. */
export const eonRhoCubedBrdf: Brdf = (wo, wi, rho, roughness) => {
  const [muO, muI, s] = cosines(wo, wi);
  const singleScatter = 1.0 + roughness * fonQuotient(muO, muI, s);
  const weight = rho * eonMultipleRatio(rho, roughness);
  const multiScatter = weight * (fonLoss(muO) * fonLoss(muI));
  return fonLambert(rho, roughness) * (singleScatter + multiScatter);
};

/** FON plus the multiple-scattering lobe of a white surface. */
export const fonWhiteLobeBrdf: Brdf = (wo, wi, rho, roughness) => {
  const [muO, muI] = cosines(wo, wi);
  const losses = fonLoss(muO) * fonLoss(muI);
  const white = ((roughness * fonAf(roughness)) / (Math.PI * (C1 - C2))) * losses;
  return fonBrdf(wo, wi, rho, roughness) + white;
};

/** QON multiplied by its own color a second time. */
export const qonTintedTwiceBrdf: Brdf = (wo, wi, rho, sigma) => rho * qonBrdf(wo, wi, rho, sigma);

/** Directional albedo of `eonRhoCubedBrdf`: rho (E_EON + (1 - rho) E_FON). */
export const eonRhoCubedAlbedoDir: AlbedoDir = (mu, rho, roughness) =>
  rho * (eonAlbedoDir(mu, rho, roughness) + (1.0 - rho) * fonAlbedoDir(mu, roughness));

/** Directional albedo of `fonWhiteLobeBrdf`: 1 - (1 - rho) E_FON. */
export const fonWhiteLobeAlbedoDir: AlbedoDir = (mu, rho, roughness) =>
  1.0 - (1.0 - rho) * fonAlbedoDir(mu, roughness);

/** Directional albedo of `qonTintedTwiceBrdf`. */
export const qonTintedTwiceAlbedoDir: AlbedoDir = (mu, rho, sigma) =>
  rho * rho * qonAlbedoDir(mu, sigma);

/**
 * Directional albedo of QON according to the fit in MaterialX 1.39.5; off by up to 0.068 at rho 1.
 */
export const qonFittedAlbedoDir: AlbedoDir = (mu, rho, sigma) => {
  const over = 1.0 - 0.4297 * sigma - 0.7632 * mu * sigma + 1.4385 * sigma ** 2;
  const under = 1.0 - 0.6076 * sigma - 0.4993 * mu * sigma + 2.0315 * sigma ** 2;
  return Math.min(over / under, 1.0) * rho;
};
