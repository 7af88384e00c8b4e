// SPDX-License-Identifier: Apache-2.0
// The page: a view, what changes it, and its parts.

import { useCallback, useEffect, useLayoutEffect, useMemo, useState } from "preact/hooks";
import { from_address, to_address } from "./address";
import { copy } from "./copies";
import type { PageData } from "./data";
import { model } from "./models/table";
import { type Pair, type Point, unit_pair, worst_point } from "./probe";
import type { Stage } from "./stage";
import type { State } from "./state";
import { Inputs } from "./ui/inputs";
import { Scene } from "./ui/lighting";
import { Material, Wanted } from "./ui/material";
import { type Measured, Probe } from "./ui/probe_panel";
import { Sides, type ViewProps } from "./ui/sides";
import { StageView } from "./ui/stage_view";
import { actual_model, consistent, meant_model, source_of, sources_of, type Sources } from "./view";

const ADDRESS_DELAY = 300; // milliseconds; browsers refuse an address that changes all the time

const MEASURE_DELAY = 60; // milliseconds
const RETRY_DELAY = 200;

interface AppProps {
  readonly data: PageData;
  /** Told of the stage and the view, for tests. */
  readonly tell: (stage: Stage | null, state: State, show: (state: State) => void) => void;
}

export function App({ data, tell }: AppProps) {
  const sources = useMemo(() => sources_of(data), [data]);
  const [state, setState] = useState(() => from_address(location.hash.slice(1), data));
  const change = useCallback(
    (patch: Partial<State>) => setState((old) => consistent({ ...old, ...patch }, sources)),
    [],
  );
  const [stage, setStage] = useState<Stage | null>(null);
  const [dragging, setDragging] = useState(false);
  useAddress(state, setState, data);
  useKeys(state, change);
  useLayoutEffect(() => tell(stage, state, setState), [stage, state]);

  const worst = useWorst(state, sources);
  const probed = stage && state.probe ? stage.pick(...state.probe, state) : null;
  const pair = probed && probed.wi[2] > 0 && probed.wo[2] > 0 ? unit_pair(probed) : worst;
  const measured = useMeasured(stage, pair, state, dragging);
  const mark = state.probe ?? (stage && state.shape === "sphere" ? on_sphere(stage, worst) : null);
  const view: ViewProps = { data, sources, state, change };
  return (
    <>
      <Header data={data} />
      <div class="columns">
        <div class="main">
          <Sides {...view} />
          <StageView {...view} mark={mark} onStage={setStage} onDrag={setDragging} />
          <Probe {...view} pair={pair} measured={measured} />
        </div>
        <aside class="controls" aria-label="Controls">
          <Material {...view} />
          <Wanted {...view} />
          <Inputs {...view} />
          <Scene {...view} />
        </aside>
      </div>
    </>
  );
}

function Header({ data }: { readonly data: PageData }) {
  const [said, say] = useState("");
  return (
    <header>
      <h1>mxeon explorer</h1>
      <p>Rough diffuse materials, two at a time: see where they differ, and by how much.</p>
      <button
        type="button"
        onClick={() =>
          void copy(location.href).then((done) => say(done ? "Copied" : "See the address"))
        }
      >
        Copy a link to this view
      </button>
      <span class="said" role="status">
        {said}
      </span>
      <small>
        mxeon {data.version}, MaterialX {data.materialx}
      </small>
    </header>
  );
}

/** Keep the address that of the view, and the view that of the address. */
function useAddress(state: State, setState: (state: State) => void, data: PageData): void {
  useEffect(() => {
    const write = (): void => {
      const address = to_address(state, data);
      if (address !== location.hash.slice(1)) {
        history.replaceState(
          null,
          "",
          address ? `#${address}` : location.pathname + location.search,
        );
      }
    };
    const timer = setTimeout(write, ADDRESS_DELAY);
    return () => clearTimeout(timer);
  }, [state]);
  useEffect(() => {
    const read = (): void => setState(from_address(location.hash.slice(1), data));
    addEventListener("hashchange", read);
    return () => removeEventListener("hashchange", read);
  }, []);
}

/** F shows the other material; D and W choose the comparison. */
function useKeys(state: State, change: (patch: Partial<State>) => void): void {
  useEffect(() => {
    const press = (event: KeyboardEvent): void => {
      const typing = (event.target as Element).matches("input:not([type=radio]), select, textarea");
      if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
      const other = state.shown === "left" ? "right" : "left";
      if (event.key === "f") change({ comparison: "flicker", shown: other });
      if (event.key === "d") change({ comparison: "difference" });
      if (event.key === "w") change({ comparison: "wipe" });
    };
    addEventListener("keydown", press);
    return () => removeEventListener("keydown", press);
  }, [state.shown]);
}

/** The point at which the sides differ most; of one model, at which it differs from Lambert. */
function useWorst(state: State, sources: Sources): Point {
  const { left, right, azimuth, elevation, color, roughness, inputs } = state;
  return useMemo(() => {
    const [first, second] = [left, right].map((side) => {
      const source = source_of(sources, side);
      return (
        actual_model(source, side, state) ?? meant_model(source, side, state) ?? model("lambert")
      );
    });
    return worst_point(first!, second!, state);
  }, [left, right, azimuth, elevation, color, roughness, inputs]);
}

/** Values of the shaders for a pair, asked when the picture is done, not to hold it up. */
function useMeasured(
  stage: Stage | null,
  pair: Pair,
  state: State,
  dragging: boolean,
): Measured | null {
  const [measured, setMeasured] = useState<Measured | null>(null);
  useEffect(() => {
    setMeasured(null);
    if (!stage || dragging) return;
    let timer = 0;
    const ask = (): void => {
      const free = state.paths || stage.isSettled(state); // paths take long
      const values = free ? stage.evaluate({ wo: [...pair.wo], wi: [...pair.wi] }, state) : null;
      setMeasured(values);
      if (!values?.left || !values.right) timer = window.setTimeout(ask, RETRY_DELAY);
    };
    timer = window.setTimeout(ask, MEASURE_DELAY);
    return () => clearTimeout(timer);
  }, [stage, pair.wo.join(), pair.wi.join(), state, dragging]);
  return measured;
}

/** Where a point of the sphere is in the picture. */
function on_sphere(stage: Stage, { normal }: Point): [number, number] {
  const { width, height } = stage.size();
  const radius = stage.diameter() / 2;
  return [0.5 + (normal[0] * radius) / width, 0.5 - (normal[1] * radius) / height];
}
