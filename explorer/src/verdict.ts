// SPDX-License-Identifier: Apache-2.0
// The verdict on a side: which model the side implements, whether the model is intended, and the
// difference.
//
// No side is called correct before this browser has read back the values of the side's shader.

import type { ShaderForm, ShaderSource } from "./data";
import { show } from "./format";
import { albedoDir, type Model } from "./models/table";
import { largestApart, worstPoint } from "./probe";
import type { Side, State } from "./state";
import { actualModel, hasTable, meantModel, type Sources, sourceOf, valuesOf } from "./view";

/**
 * "within" is a visible difference within the tolerance. "differs" is a difference from the
 * reference that the specification permits.
 */
type Kind = "correct" | "within" | "wrong" | "differs" | "model" | "unknown" | "measuring";

export interface Verdict {
  readonly kind: Kind;
  readonly badge: string;
  readonly text: string;
}

/** Largest difference between a shader's values and those of its reference, for its own inputs. */
export interface ErrorOf {
  readonly error: number;
  readonly row: number; // index of the pair or view with the largest difference
  readonly form: ShaderForm | null; // permitted form that matches, if the reference does not
}

export interface Errors {
  readonly direct: ErrorOf; // pi f cos of all pairs of directions
  readonly white: ErrorOf; // light returned in white surroundings
}

/** Values that this browser read back from a side's shader. */
export interface Evidence {
  readonly able: boolean; // whether the browser can draw
  /** Whether the shader has the values of its claimed model; null until known. */
  readonly confirmed: boolean | null;
  readonly errors: Errors | null; // null until known, or if there is no reference
  readonly failure: string; // compiler message if the shader does not compile
}

const BADGES = {
  correct: "correct",
  within: "within tolerance",
  wrong: "wrong",
  differs: "allowed",
  unknown: "material",
};
const VISIBLE = 0.01; // approximate smallest visible difference, as a share of white
const MEASURING = "Reading back the shader's values.";
const UNCHECKED = "Not judged here: run mxeon check on a document with these inputs.";
const UNREAD = "Not measured: this browser cannot draw shaders.";

/** The verdict on a side for the colors, roughness and light of a view. */
export function verdictOn(state: State, sources: Sources, side: Side, evidence: Evidence): Verdict {
  const source = sourceOf(sources, side);
  if (evidence.failure) return { kind: "wrong", badge: "not drawn", text: evidence.failure };
  const [actual, meant] = [actualModel(source, side, state), meantModel(source, side, state)];
  const checked = source.kind === "shader" ? source.checked : null;
  const changed = checked && source.kind === "shader" && isChanged(source, state, side);
  const text = checked ? (changed ? "With its own inputs: " : "") + checked.text : "";
  if (!actual || !meant) {
    const own = hasTable(source) ? byReference(source, evidence) : null;
    if (checked) {
      const { kind } = checked;
      // This browser's values may be wrong where `mxeon check` is right.
      if (own && isRight(kind) && own.kind !== "unknown") {
        if (isRight(own.kind)) return { kind, badge: BADGES[kind], text };
        // The page has no permitted forms of layers, so the result of `mxeon check` stands.
        if (own.kind !== "differs" || changed) return own;
        return { kind, badge: BADGES[kind], text: `${text} ${own.text}` };
      }
      if (changed) return { kind: "unknown", badge: "material", text };
      return { kind, badge: BADGES[kind], text };
    }
    if (own) return own;
    return { kind: "unknown", badge: "material", text: UNCHECKED };
  }
  if (actual !== meant) {
    const of = text ? `${text} It is ${actual.title}.` : wrong(actual, meant, state);
    return { kind: "wrong", badge: `not ${meant.short}`, text: of };
  }
  if (source.kind === "model") {
    return { kind: "model", badge: actual.short, text: `The model itself: ${actual.title}.` };
  }
  return byModel(actual, evidence);
}

function isRight(kind: Kind): boolean {
  return kind === "correct" || kind === "within";
}

/** Whether inputs of a document's material have changed since `mxeon check` judged the material. */
function isChanged(source: ShaderSource, state: State, side: Side): boolean {
  const drawn = valuesOf(source, state, side);
  return source.inputs.some(
    ({ name, value }) => value !== null && String(drawn.get(name)) !== String(value),
  );
}

/** The verdict on a shader that claims to be the intended model. */
function byModel({ short, title }: Model, { able, confirmed }: Evidence): Verdict {
  if (!able) return { kind: "model", badge: short, text: UNREAD };
  if (confirmed === null) return { kind: "measuring", badge: "measuring", text: MEASURING };
  if (!confirmed)
    return { kind: "wrong", badge: `not ${short}`, text: "The probe shows by how much." };
  return { kind: "correct", badge: short, text: `Correct: ${title}.` };
}

/** The verdict on a shader according to the table of its reference. */
function byReference(source: ShaderSource, { able, errors }: Evidence): Verdict {
  const { bounds, forms } = source.reference!;
  if (!able) return { kind: "unknown", badge: "material", text: UNREAD };
  if (!errors) return { kind: "measuring", badge: "measuring", text: MEASURING };
  const { direct, white } = errors;
  const places = [
    { ...direct, bound: bounds.direct, light: "direct light" },
    { ...white, bound: bounds.white, light: "a white environment" },
  ].filter(({ error, bound }) => !(error <= bound));
  if (places.length === 0) {
    const [first, second] = [show(direct.error, 2), show(white.error, 2)];
    const text = `Within ${first} of float64 in direct light, ${second} in a white environment.`;
    const kind = direct.error > VISIBLE || white.error > VISIBLE ? "within" : "correct";
    return { kind, badge: BADGES[kind], text };
  }
  const parts = places.map(({ error, light }) => `${show(error, 2)} in ${light}`);
  const title = places.find(({ form }) => form)?.form?.title;
  const off = `Error up to ${parts.join(", ")}`;
  const named = title ? `: ${title}` : "";
  // The page has no permitted forms of layers, but each lobe of a layer may have a permitted form.
  if (forms.length === 0) {
    const hint = "Open each lobe to see which part is allowed.";
    return { kind: "differs", badge: "differs", text: `${off}. ${hint}` };
  }
  if (places.every(({ form }) => form?.permitted)) {
    const text = `${off}${named}. The specification allows this.`;
    return { kind: "differs", badge: BADGES.differs, text };
  }
  return { kind: "wrong", badge: "wrong", text: `${off}${named}.` };
}

/** A sentence about how the actual model differs from the intended model. */
function wrong(actual: Model, meant: Model, state: State): string {
  const { color, roughness } = state;
  const here = Math.abs(worstPoint(actual, meant, state).apart);
  const anywhere = Math.abs(largestApart(actual, meant, color, roughness));
  const albedo = albedoError(actual, meant, state);
  const parts = [`It is ${actual.title}`];
  if (actual.wrong && actual.meant === meant.name) parts.push(actual.wrong);
  const amount = [];
  if (anywhere > 1e-9) {
    amount.push(`Error up to ${show(here, 2)} in this light, ${show(anywhere, 2)} in any light.`);
  }
  if (albedo > 1e-9) amount.push(`In an environment, albedo error up to ${show(albedo, 2)}.`);
  if (amount.length === 0) amount.push("At this color and roughness, both models are equal.");
  return `${parts.join(": ")}. ${amount.join(" ")}`;
}

/** The largest difference of two albedos; 0 if a model has no closed form. */
function albedoError(actual: Model, meant: Model, { color, roughness }: State): number {
  if (!actual.albedoDir || !meant.albedoDir) return 0.0;
  let most = 0.0;
  for (let step = 0; step <= 32; step++) {
    for (const rho of color) {
      const [is, should] = [actual, meant].map((of) => albedoDir(of, step / 32, rho, roughness));
      most = Math.max(most, Math.abs(is! - should!));
    }
  }
  return most;
}
