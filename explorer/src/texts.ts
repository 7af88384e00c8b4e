// SPDX-License-Identifier: Apache-2.0
// Texts of shaders and documents. The page stores each paragraph, reference and image once.

import type { ModelSource, PageData, Port, ReferenceTable, ShaderSource, Texels } from "./data";

interface PackedPort extends Omit<Port, "image"> {
  readonly image: number | null;
}

/** A shader whose texts, reference and images are indices into the tables. */
interface Packed extends Omit<
  ShaderSource,
  "pixel" | "paths" | "document" | "reference" | "inputs"
> {
  readonly inputs: readonly PackedPort[];
  readonly pixel: readonly number[];
  readonly paths: readonly number[];
  readonly document: readonly number[];
  readonly reference: number | null;
}

interface PackedData extends Omit<PageData, "sources"> {
  readonly sources: readonly (ModelSource | Packed)[];
  readonly texts: readonly string[];
  readonly references: readonly ReferenceTable[];
  readonly images: readonly Texels[];
}

/** The data that Python embeds, with the indices replaced by the texts. */
export function pageData(json: string): PageData {
  const { texts, references, images, sources, ...rest } = JSON.parse(json) as PackedData;
  const whole = (places: readonly number[]) => places.map((place) => texts[place]).join("\n\n");
  const unpacked = sources.map((source) =>
    source.kind === "model"
      ? source
      : {
          ...source,
          pixel: whole(source.pixel),
          paths: whole(source.paths),
          document: whole(source.document),
          inputs: source.inputs.map((port) => ({
            ...port,
            image: port.image === null ? null : images[port.image]!,
          })),
          reference: source.reference === null ? null : references[source.reference]!,
        },
  );
  return { ...rest, sources: unpacked };
}
