// SPDX-License-Identifier: Apache-2.0
// Shader sources are imported as text.
declare module "*.glsl" {
  const text: string;
  export default text;
}

// GLSL functions of the models for one channel, which build.mjs translates to JavaScript.
declare module "glsl:models" {
  type Direction = readonly [number, number, number];
  type Value = (wo: Direction, wi: Direction, rho: number, parameter: number) => number;
  type AlbedoDir = (mu: number, rho: number, parameter: number) => number;
  type White = (mu: number, parameter: number) => number;
  export const lambert_brdf: Value, oren_nayar_brdf: Value, qon_brdf: Value, fon_brdf: Value;
  export const qon_footnote_brdf: Value, qon_fujii_brdf: Value, eon_brdf: Value;
  export const eon_brdf_approx: Value, eon_clamped_brdf: Value, eon_rho_cubed_brdf: Value;
  export const fon_white_lobe_brdf: Value, qon_tinted_twice_brdf: Value;
  export const eon_albedo_dir: AlbedoDir, eon_rho_cubed_albedo_dir: AlbedoDir;
  export const fon_white_lobe_albedo_dir: AlbedoDir, qon_fitted_albedo_dir: AlbedoDir;
  export const qon_tinted_twice_albedo_dir: AlbedoDir;
  export const qon_albedo_dir: White, fon_albedo_dir: White;
  export const eon_albedo_avg: (rho: number, roughness: number) => number;
  export const qon_albedo_avg: (sigma: number) => number;
  export const fon_albedo_avg: (roughness: number) => number;
}
