// SPDX-License-Identifier: Apache-2.0
// Functions of a view and its data, such as the models and titles of both sides.

import type { PageData, ShaderSource, Source, Triple } from "./data";
import { model, rhoFromAlbedo, type Model, type ModelName } from "./models/table";
import { INITIAL, type Side, type SideName, type State, type Value } from "./state";

export const SIDES = ["left", "right"] as const;

/** Letters that name the sides for readers. */
export const LETTER: Readonly<Record<SideName, string>> = { left: "A", right: "B" };

/** The sources of the page, by id. */
export type Sources = ReadonlyMap<string, Source>;

export function sourcesOf(data: PageData): Sources {
  return new Map(data.sources.map((source) => [source.id, source]));
}

/** The source shown on a side. */
export function sourceOf(sources: Sources, side: Side): Source {
  return sources.get(side.source)!;
}

/** The model of a side; null if only the shader's values reveal the model. */
export function actualModel(source: Source, side: Side, state: State): Model | null {
  if (source.kind === "model") return model(source.model);
  return source.actual && !isChanged(source, state) ? model(byFlag(source.actual, side)) : null;
}

/** The intended model of a side, or null. */
export function meantModel(source: Source, side: Side, state: State): Model | null {
  if (source.kind === "model") return model(source.meant);
  return source.meant && !isChanged(source, state) ? model(byFlag(source.meant, side)) : null;
}

/** Whether a shader is judged by its reference table, because the page lacks the model. */
export function hasTable(source: Source): source is ShaderSource {
  return source.kind === "shader" && !!source.reference && !(source.meant && source.actual);
}

/** Values of a side's reference in a row of its table, for the source's initial inputs. */
export function tabled(source: Source, state: State, row: number | null): Triple | null {
  if (row === null || !hasTable(source) || isChanged(source, state)) return null;
  const [r, g, b] = source.reference?.direct.slice(3 * row, 3 * row + 3) ?? [];
  return r === undefined ? null : [r, g!, b!];
}

/** Whether an input of a document, such as its weight, was changed. */
function isChanged(source: ShaderSource, state: State): boolean {
  const values = state.inputs[source.id] ?? {};
  return source.inputs.some(({ name, value }) => name in values && values[name] !== value);
}

function byFlag(of: { on: ModelName; off: ModelName }, side: Side): ModelName {
  return side.flag ? of.on : of.off;
}

/** Whether a side has energy_compensation. */
export function hasFlag(source: Source): boolean {
  return source.kind === "shader" && source.controls.flag !== "";
}

/** A short name for a side. */
export function shortTitle(source: Source, side: Side): string {
  if (source.kind === "model") return source.title.split(":")[0]!.replace(/.*\((.*)\)$/, "$1");
  if (hasFlag(source)) return `${source.library}, energy_compensation ${side.flag}`;
  return source.title;
}

/** A view whose color follows from the requested albedo, if the reader requests an albedo. */
export function consistent(state: State, sources: Sources): State {
  if (!state.keep) return state;
  const of = inversionModel(state, sources);
  return { ...state, color: enter(of, state.wanted, state.roughness, state.average) };
}

/** The intended model of the left side, whose albedo is inverted. */
function inversionModel(state: State, sources: Sources): Model {
  return meantModel(sourceOf(sources, state.left), state.left, state) ?? model("eon");
}

/** The color for which a model has the wanted albedo. */
export function enter(
  of: Model,
  wanted: Readonly<Triple>,
  roughness: number,
  average: boolean,
): Triple {
  const [r, g, b] = wanted;
  const one = (seen: number): number => rhoFromAlbedo(of, seen, roughness, average);
  return [one(r), one(g), one(b)];
}

/** A view with another source on a side; documents set color, roughness and flag. */
export function withSource(
  state: State,
  sources: Sources,
  side: SideName,
  id: string,
): Partial<State> {
  const source = sources.get(id)!;
  const change = { [side]: { ...state[side], source: id } };
  if (source.kind === "model" || !source.id.startsWith("document/")) return change;
  const value = (name: string): Value | null | undefined =>
    source.inputs.find((port) => port.name === name)?.value;
  const { color, roughness, flag } = source.controls;
  return {
    [side]: { ...state[side], source: id, flag: Boolean(value(flag) ?? state[side].flag) },
    color: (value(color) as Triple | undefined) ?? state.color,
    roughness: (value(roughness) as number | undefined) ?? state.roughness,
    keep: false,
  };
}

/** A view of a shader with its own inputs. */
export function ownView(source: ShaderSource): State {
  const value = (name: string) => source.inputs.find((port) => port.name === name)?.value;
  const { color, roughness, flag } = source.controls;
  return {
    ...INITIAL,
    left: { ...INITIAL.left, source: source.id, flag: Boolean(value(flag)) },
    color: (value(color) as Triple | undefined) ?? INITIAL.color,
    roughness: (value(roughness) as number | undefined) ?? INITIAL.roughness,
  };
}

/** Values of a shader's inputs in the drawn picture, by uniform name. */
export function valuesOf(source: ShaderSource, state: State, side: Side): Map<string, Value> {
  const values = new Map<string, Value>();
  for (const port of source.inputs) {
    if (port.value !== null) values.set(port.name, port.value);
  }
  const { color, roughness, flag } = source.controls;
  if (color) values.set(color, state.color);
  if (roughness) values.set(roughness, state.roughness);
  if (flag) values.set(flag, side.flag);
  for (const [name, value] of Object.entries(state.inputs[source.id] ?? {})) {
    if (values.has(name)) values.set(name, value);
  }
  return values;
}

/** A material's id without the library. */
export function stemOf(id: string): string {
  return id.replace(/[^/]*$/, "");
}

/** Titles of the materials with shaders on the page, by the common part of their ids. */
export function materialsOf(data: PageData): ReadonlyMap<string, string> {
  const shaders = data.sources.filter((source) => source.kind === "shader");
  const own = shaders.filter(({ id }) => id.startsWith("document/"));
  return new Map(
    [...own, ...shaders].map(({ id, title }) => [stemOf(id), title.replace(/, [^,]*$/, "")]),
  );
}

/** A view of a material with both libraries, or with the only library that has the material. */
export function withMaterial(state: State, sources: Sources, stem: string): Partial<State> {
  const ids = [...sources.keys()].filter((id) => stemOf(id) === stem);
  const [first, second = first] = ids;
  const change = withSource(state, sources, "left", first!);
  const shape = stem.includes("hair") ? "fiber" : state.shape === "fiber" ? "ball" : state.shape;
  const right = { ...state.right, ...change.left, source: second! };
  return { ...change, right, shape, ...lightFor(state, stem) };
}

const FRONT = { azimuth: 40, elevation: 45 }; // direction that shows highlights

/**
 * The default light of a material, unless the reader has moved it: diffuse models differ most when
 * lit from behind.
 */
function lightFor(state: State, stem: string): Partial<State> {
  const first = { azimuth: INITIAL.azimuth, elevation: INITIAL.elevation };
  const isAt = (light: typeof FRONT): boolean =>
    state.azimuth === light.azimuth && state.elevation === light.elevation;
  if (!isAt(first) && !isAt(FRONT)) return {};
  return stem.startsWith("lobe/") ? FRONT : first;
}

/** The first view of a page, which shows the first document, if any. */
export function firstView(data: PageData): State {
  const sources = sourcesOf(data);
  const documents = data.sources.filter((source) => source.id.startsWith("document/"));
  const [first] = documents;
  const initial: State = { ...INITIAL, surroundings: data.sky ? "own" : INITIAL.surroundings };
  if (!first) return initial;
  const twin = documents.find((each) => each !== first && stemOf(each.id) === stemOf(first.id));
  const left = { ...initial, ...withSource(initial, sources, "left", first.id) };
  return twin ? { ...left, right: { ...left.left, source: twin.id } } : left;
}
