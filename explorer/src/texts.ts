// SPDX-License-Identifier: Apache-2.0
// Texts of shaders and documents, which the page holds by paragraphs, each of them once.

import type { ModelSource, PageData, ShaderSource } from "./data";

/** A shader whose texts are places in the table. */
interface Packed extends Omit<ShaderSource, "pixel" | "document"> {
  readonly pixel: readonly number[];
  readonly document: readonly number[];
}

interface PackedData extends Omit<PageData, "sources"> {
  readonly sources: readonly (ModelSource | Packed)[];
  readonly texts: readonly string[];
}

/** The data that Python embeds, with the texts in their places. */
export function page_data(json: string): PageData {
  const { texts, sources, ...rest } = JSON.parse(json) as PackedData;
  const whole = (places: readonly number[]) => places.map((place) => texts[place]).join("\n\n");
  const unpacked = sources.map((source) =>
    source.kind === "model"
      ? source
      : { ...source, pixel: whole(source.pixel), document: whole(source.document) },
  );
  return { ...rest, sources: unpacked };
}
