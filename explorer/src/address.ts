// SPDX-License-Identifier: Apache-2.0
// Converts a view to the part of an address after "#" and back. Only fields that differ from the
// first view are written. Unreadable fields keep the value of the first view.

import type { PageData, Vec3 } from "./data";
import {
  COMPARISONS,
  SAMPLERS,
  SHAPES,
  SURROUNDINGS,
  ZOOMS,
  type Side,
  type State,
  type Value,
} from "./state";
import { consistent, firstView, sourcesOf } from "./view";

interface Codec<T> {
  readonly write: (value: T) => string;
  /** The value that a text represents; undefined if there is no text. */
  readonly read: (text: string, first: T) => T | undefined;
}

const DIGITS = 5; // digits of numbers in an address; more digits would not be visible

function short(value: number): string {
  return String(Number(value.toPrecision(DIGITS)));
}

function number(low: number, high: number): Codec<number> {
  return {
    write: short,
    read: (text) => {
      const value = Number(text);
      return text.trim() === "" || Number.isNaN(value)
        ? undefined
        : Math.min(Math.max(value, low), high);
    },
  };
}

function word<T extends string>(words: readonly T[]): Codec<T> {
  return { write: String, read: (text) => words.find((each) => each === text) };
}

const flag: Codec<boolean> = {
  write: (value) => (value ? "1" : "0"),
  read: (text) => ({ "1": true, "0": false })[text],
};

const unit = number(0, 1);

function numbers<T extends readonly number[]>(count: number, one: Codec<number>): Codec<T> {
  return {
    write: (value) => value.map(one.write).join(","),
    read: (text) => {
      const values = text.split(",").map((part) => one.read(part, 0));
      const whole = values.length === count && values.every((each) => each !== undefined);
      return whole ? (values as unknown as T) : undefined;
    },
  };
}

const side: Codec<Side> = {
  write: ({ source, flag: on, sampler }) => [source, flag.write(on), sampler].join(","),
  read: (text, first) => {
    const [source = "", on = "", sampler = ""] = text.split(",");
    return {
      source,
      flag: flag.read(on, first.flag) ?? first.flag,
      sampler: SAMPLERS.find((each) => each === sampler) ?? first.sampler,
    };
  },
};

const probe: Codec<State["probe"]> = {
  write: (value) => (value ? value.map(unit.write).join(",") : ""),
  read: (text) => numbers<[number, number]>(2, unit).read(text, [0, 0]) ?? null,
};

/** Keys of the address: short words that must not change, because readers keep and share links. */
const FIELDS: { readonly [K in keyof Omit<State, "inputs">]: [string, Codec<State[K]>] } = {
  left: ["a", side],
  right: ["b", side],
  comparison: ["compare", word(COMPARISONS)],
  wipe: ["wipe", unit],
  scale: ["scale", number(1e-8, 10)],
  shown: ["shown", word(["left", "right"])],
  shape: ["shape", word(SHAPES)],
  turn: ["turn", number(-180, 180)],
  tilt: ["tilt", number(-90, 90)],
  zoom: ["zoom", number(...ZOOMS)],
  azimuth: ["azimuth", number(-180, 180)],
  elevation: ["elevation", number(-90, 90)],
  light: ["light", number(0, 10)],
  surroundings: ["surroundings", word(SURROUNDINGS)],
  exposure: ["exposure", number(-10, 10)],
  color: ["color", numbers<Vec3>(3, unit)],
  roughness: ["roughness", unit],
  wanted: ["wanted", numbers<Vec3>(3, unit)],
  average: ["average", flag],
  keep: ["keep", flag],
  paths: ["paths", flag],
  samples: ["samples", number(1, 65536)],
  probe: ["probe", probe],
};

const INPUT = "input:"; // prefix of keys such as "input:SOURCE:UNIFORM"

/** The address of a view, without "#". */
export function toAddress(state: State, data: PageData): string {
  const first = firstView(data);
  const parts = new URLSearchParams();
  for (const name of Object.keys(FIELDS) as (keyof typeof FIELDS)[]) {
    const [key, codec] = FIELDS[name] as [string, Codec<unknown>];
    const text = codec.write(state[name]);
    if (text !== codec.write(first[name])) parts.set(key, text);
  }
  for (const [source, values] of Object.entries(state.inputs)) {
    for (const [name, value] of Object.entries(values)) {
      parts.set(`${INPUT}${source}:${name}`, writeValue(value));
    }
  }
  // Slashes, colons and commas are legal in a fragment.
  return parts.toString().replaceAll("%2F", "/").replaceAll("%2C", ",").replaceAll("%3A", ":");
}

/** The view of an address, without "#". */
export function fromAddress(address: string, data: PageData): State {
  const parts = new URLSearchParams(address);
  const sources = sourcesOf(data);
  const first = firstView(data);
  const state: Record<string, unknown> = { ...first };
  for (const name of Object.keys(FIELDS) as (keyof typeof FIELDS)[]) {
    const [key, codec] = FIELDS[name] as [string, Codec<unknown>];
    const text = parts.get(key);
    if (text !== null) state[name] = codec.read(text, first[name]) ?? first[name];
  }
  for (const name of ["left", "right"] as const) {
    if (!sources.has((state[name] as Side).source)) state[name] = first[name];
  }
  state["inputs"] = readInputs(parts, data);
  return consistent(state as unknown as State, sources);
}

function writeValue(value: Value): string {
  if (typeof value === "boolean") return value ? "true" : "false";
  return typeof value === "number" ? short(value) : value.map(short).join(",");
}

/** Input values that exist on the page and have the right type and length. */
function readInputs(parts: URLSearchParams, data: PageData): State["inputs"] {
  const inputs: Record<string, Record<string, Value>> = {};
  for (const source of data.sources) {
    if (source.kind !== "shader") continue;
    for (const port of source.inputs) {
      const text = parts.get(`${INPUT}${source.id}:${port.name}`);
      const value = text === null ? undefined : readValue(text, port.value);
      if (value !== undefined) (inputs[source.id] ??= {})[port.name] = value;
    }
  }
  return inputs;
}

function readValue(text: string, like: Value | null): Value | undefined {
  if (typeof like === "boolean") return { true: true, false: false }[text];
  const all = number(-1e9, 1e9);
  if (typeof like === "number") return all.read(text, like);
  return like ? numbers(like.length, all).read(text, like) : undefined;
}
