// SPDX-License-Identifier: Apache-2.0
// Computes and reads back values while a view is at rest, so that pictures are never delayed.

import { useEffect, useMemo, useState } from "preact/hooks";
import { isOther, type Pair, values } from "./probe";
import type { Stage } from "./stage";
import type { SideName, State } from "./state";
import type { Measured } from "./ui/probe_panel";
import type { Errors, Evidence } from "./verdict";
import { actualModel, hasTable, SIDES, sourceOf, type Sources } from "./view";

const REST = 120; // milliseconds without a change until a view is at rest
const MEASURE_DELAY = 60;
const RETRY = 100;

/** The latest view at rest whose picture was drawn; null before the first picture. */
export function useRest(
  stage: Stage | null | undefined,
  state: State,
  dragging: boolean,
): State | null {
  const [rest, setRest] = useState<State | null>(null);
  useEffect(() => {
    if (stage === undefined || dragging) return;
    let timer = 0;
    const look = (): void => {
      if (!stage || stage.isDrawn(state)) setRest(state);
      else timer = window.setTimeout(look, RETRY);
    };
    timer = window.setTimeout(look, rest && stage ? REST : 0);
    return () => clearTimeout(timer);
  }, [stage, state, dragging]);
  return rest;
}

/**
 * Shader values for a pair, requested after the picture is done; null until the values arrive.
 * Values are stored with a view, so that no frame shows the values of another view.
 */
export function useMeasured(
  stage: Stage | null | undefined,
  pair: Pair,
  state: State,
  moving: boolean,
): Measured | null {
  const [measured, setMeasured] = useState<{ of: Pair; values: Measured | null } | null>(null);
  const of = useMemo(() => ({ ...pair }), [stage, pair.wo.join(), pair.wi.join(), state, moving]);
  useEffect(() => {
    if (!stage || moving) return;
    let timer = 0;
    const ask = (): void => {
      const free = state.paths || stage.isSettled(state); // do not wait for paths, which take long
      const read = free ? stage.evaluate({ wo: [...of.wo], wi: [...of.wi] }, state) : null;
      setMeasured({ of, values: read });
      if (!read?.left || !read.right) timer = window.setTimeout(ask, RETRY);
    };
    timer = window.setTimeout(ask, MEASURE_DELAY);
    return () => clearTimeout(timer);
  }, [of]);
  return measured?.of === of ? measured.values : null;
}

/** Errors of shaders against reference tables, by source id. */
export type ErrorsOf = ReadonlyMap<string, Errors>;

/** The errors of both sides, computed one after the other once the probe's values are known. */
export function useErrors(
  stage: Stage | null | undefined,
  sources: Sources,
  state: State,
  measured: Measured | null,
  [errors, setErrors]: [ErrorsOf, (errors: ErrorsOf) => void],
): void {
  useEffect(() => {
    if (!stage || !measured) return;
    const asked = SIDES.map((side) => sourceOf(sources, state[side]))
      .filter(hasTable)
      .find(({ id }) => !errors.has(id));
    if (!asked) return;
    const timer = window.setTimeout(() => {
      const found = stage.check(asked);
      if (found) setErrors(new Map(errors).set(asked.id, found));
    });
    return () => clearTimeout(timer);
  }, [stage, measured, errors]);
}

/** Row of the reference tables with the largest error; null unless both sides have such a table. */
export function farthestRow(sources: Sources, state: State, errors: ErrorsOf): number | null {
  const sides = SIDES.map((side) => sourceOf(sources, state[side]));
  const found = sides
    .filter(hasTable)
    .map((each) => errors.get(each.id)?.direct)
    .filter((each) => each !== undefined);
  if (found.length === 0 || found.length < sides.length) return null;
  return found.reduce((most, each) => (each.error > most.error ? each : most)).row;
}

/** All values that were read back from the shaders of both sides so far. */
export function useEvidence(
  stage: Stage | null | undefined,
  sources: Sources,
  state: State,
  pair: Pair,
  measured: Measured | null,
  errors: ErrorsOf,
): Readonly<Record<SideName, Evidence>> {
  const [confirmed, setConfirmed] = useState<ReadonlyMap<string, boolean>>(new Map());
  const key = (side: SideName, of: string): string => `${state[side].source} ${of}`;
  useEffect(() => {
    if (!measured) return;
    const found = new Map(confirmed);
    for (const side of SIDES) {
      const of = actualModel(sourceOf(sources, state[side]), state[side], state);
      const value = measured[side];
      if (!of || !value) continue;
      const right = !isOther(value, values(of, pair, state.color, state.roughness));
      found.set(key(side, of.name), right && found.get(key(side, of.name)) !== false);
    }
    setConfirmed(found);
  }, [measured]);
  const one = (side: SideName): Evidence => {
    const of = actualModel(sourceOf(sources, state[side]), state[side], state);
    return {
      able: stage !== null,
      confirmed: (of && confirmed.get(key(side, of.name))) ?? null,
      errors: errors.get(state[side].source) ?? null,
      failure: stage?.failure(state[side].source) ?? "",
    };
  };
  return { left: one("left"), right: one("right") };
}
