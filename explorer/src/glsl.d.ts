// SPDX-License-Identifier: Apache-2.0
// Shader sources are imported as text.
declare module "*.glsl" {
  const text: string;
  export default text;
}
