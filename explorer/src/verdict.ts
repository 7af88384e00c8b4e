// SPDX-License-Identifier: Apache-2.0
// What a side is, whether it is what it should be, and by how much it is not.

import { show } from "./format";
import { albedo_dir, type Model } from "./models/table";
import { largest_apart, worst_point } from "./probe";
import type { Side, State } from "./state";
import { actual_model, meant_model, type Sources, source_of } from "./view";

export type Kind = "correct" | "wrong" | "model" | "unknown";

export interface Verdict {
  readonly kind: Kind;
  readonly badge: string;
  readonly text: string;
}

/** The verdict on a side, for the colors, the roughness and the light of a view. */
export function verdict_on(state: State, sources: Sources, side: Side): Verdict {
  const source = source_of(sources, side);
  const [actual, meant] = [actual_model(source, side, state), meant_model(source, side, state)];
  if (!actual || !meant) {
    return {
      kind: "unknown",
      badge: "material",
      text: "No single model: compare it with the other side.",
    };
  }
  if (actual === meant) {
    if (source.kind === "model") {
      return { kind: "model", badge: actual.short, text: `The model itself: ${actual.title}.` };
    }
    return { kind: "correct", badge: actual.short, text: `Correct: ${actual.title}.` };
  }
  return { kind: "wrong", badge: `not ${meant.short}`, text: wrong(actual, meant, state) };
}

/** A sentence on a model that is not the one that is meant. */
function wrong(actual: Model, meant: Model, state: State): string {
  const { color, roughness } = state;
  const here = Math.abs(worst_point(actual, meant, state).apart);
  const anywhere = Math.abs(largest_apart(actual, meant, color, roughness));
  const albedo = albedo_error(actual, meant, state);
  const parts = [`It is ${actual.title}`];
  if (actual.wrong && actual.meant === meant.name) parts.push(actual.wrong);
  const amount = [];
  if (anywhere > 1e-9) {
    amount.push(
      `Off by up to ${show(here, 2)} in this light and ${show(anywhere, 2)} in any, ` +
        "in units of \u03c0 f cos\u03b8.",
    );
  }
  if (albedo > 1e-9) amount.push(`In surroundings its albedo is off by up to ${show(albedo, 2)}.`);
  if (amount.length === 0) amount.push("At this color and roughness both are the same.");
  return `${parts.join(": ")}. ${amount.join(" ")}`;
}

/** The largest difference of two albedos in closed form; 0 where there is none. */
function albedo_error(actual: Model, meant: Model, { color, roughness }: State): number {
  if (!actual.albedo_dir || !meant.albedo_dir) return 0.0;
  let most = 0.0;
  for (let step = 0; step <= 32; step++) {
    for (const rho of color) {
      const [is, should] = [actual, meant].map((of) => albedo_dir(of, step / 32, rho, roughness));
      most = Math.max(most, Math.abs(is! - should!));
    }
  }
  return most;
}
