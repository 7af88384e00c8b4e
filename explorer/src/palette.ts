// SPDX-License-Identifier: Apache-2.0
// Colors of the difference map, sRGB, at -1, -1/2, 0, 1/2 and 1 times its scale; linear in between.

export const DIFFERENCE = [
  [122, 190, 255],
  [42, 105, 190],
  [58, 60, 66],
  [196, 92, 30],
  [255, 190, 92],
] as const;
