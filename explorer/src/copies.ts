// SPDX-License-Identifier: Apache-2.0
// Texts for the copy buttons: a MaterialX document, its shader, and Python code for a value.

import type { PageData, Source } from "./data";
import type { Model } from "./models/table";
import type { Pair } from "./probe";
import type { Side, State, Value } from "./state";
import { type Sources, valuesOf } from "./view";

/** The material of a side as a MaterialX document; null if no node has this model. */
export function materialX(
  state: State,
  sources: Sources,
  source: Source,
  side: Side,
): string | null {
  if (source.kind === "shader") return withValues(source, valuesOf(source, state, side));
  const node = sources.get("shader/eonlib");
  if (source.model !== source.meant || node?.kind !== "shader") return null;
  if (source.model !== "eon" && source.model !== "qon") return null;
  const flagged = { ...side, flag: source.model === "eon" };
  return withValues(node, valuesOf(node, state, flagged));
}

/** A MaterialX document with the given input values. */
function withValues(
  source: Extract<Source, { kind: "shader" }>,
  values: ReadonlyMap<string, Value>,
): string {
  const document = new DOMParser().parseFromString(source.document, "text/xml");
  for (const port of source.inputs) {
    const value = values.get(port.name);
    if (value === undefined || value === port.value || port.image) continue;
    const input = inputOf(document, port.path, port.type);
    if (input) input.setAttribute("value", textOf(value));
  }
  return new XMLSerializer().serializeToString(document);
}

/** The element of a name path, created if missing in the node; null if the node does not exist. */
function inputOf(document: Document, path: string, type: string): Element | null {
  const names = path.split("/");
  const last = names.pop()!;
  let element: Element = document.documentElement;
  for (const name of names) {
    const child = [...element.children].find((each) => each.getAttribute("name") === name);
    if (!child) return null;
    element = child;
  }
  const input = [...element.children].find((each) => each.getAttribute("name") === last);
  if (input) return input;
  const made = document.createElement("input");
  made.setAttribute("name", last);
  made.setAttribute("type", type);
  element.append(made, "\n");
  return made;
}

function textOf(value: Value): string {
  return typeof value === "object" ? value.map(String).join(", ") : String(value);
}

/** The shader text of a side; null for a variant that eonlib lacks. */
export function shaderText(data: PageData, source: Source): string | null {
  if (source.kind === "shader") return source.pixel;
  if (source.model !== source.meant) return null;
  return `// ${source.model}_brdf is one of these functions.\n${data.functions}`;
}

/** A line of Python that prints pi f cos(theta_i) of a model for a pair, per channel. */
export function pythonLine(of: Model, { wo, wi }: Pair, state: State): string {
  const parameter = of.parameter ? `, ${state.roughness}` : "";
  const list = (values: readonly number[]): string => `[${values.join(", ")}]`;
  return (
    "from math import pi; from mxeon import model; " +
    `print(*(pi * ${wi[2]} * model("${of.name}")` +
    `.brdf(${list(wo)}, ${list(wi)}, ${list(state.color)}${parameter})))`
  );
}

/** Copy a text, with an older method if the page may not use the clipboard. */
export async function copy(text: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const area = document.createElement("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    return done;
  }
}
