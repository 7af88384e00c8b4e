// SPDX-License-Identifier: Apache-2.0
// The page, which has a view, actions that change the view, and parts that show the view.

import { useCallback, useEffect, useLayoutEffect, useMemo, useState } from "preact/hooks";
import { fromAddress, toAddress } from "./address";
import { copy } from "./copies";
import type { PageData } from "./data";
import {
  type ErrorsOf,
  farthestRow,
  useErrors,
  useEvidence,
  useMeasured,
  useRest,
} from "./measuring";
import { model } from "./models/table";
import { facingPoint, type Point, unitPair, worstPoint } from "./probe";
import type { Stage } from "./stage";
import { toSide } from "./stage/scenes";
import type { State } from "./state";
import { Dropped } from "./ui/dropped";
import { Inputs } from "./ui/inputs";
import { Scene } from "./ui/lighting";
import { Material, Wanted } from "./ui/material";
import { Probe } from "./ui/probe_panel";
import { Materials, Sides, type ViewProps } from "./ui/sides";
import { StageView } from "./ui/stage_view";
import { actualModel, consistent, meantModel, sourceOf, sourcesOf, type Sources } from "./view";

const ADDRESS_DELAY = 300; // milliseconds; browsers refuse frequent changes of the address

interface AppProps {
  readonly data: PageData;
  /** Receives the stage and the view, for tests. */
  readonly publish: (stage: Stage | null, state: State, show: (state: State) => void) => void;
}

export function App({ data, publish }: AppProps) {
  const sources = useMemo(() => sourcesOf(data), [data]);
  const [state, setState] = useState(() => fromAddress(location.hash.slice(1), data));
  const change = useCallback(
    (patch: Partial<State>) => setState((old) => consistent({ ...old, ...patch }, sources)),
    [],
  );
  // undefined until the browser has been tested, null if the browser cannot draw
  const [stage, setStage] = useState<Stage | null | undefined>(undefined);
  const [dragging, setDragging] = useState(false);
  useAddress(state, setState, data);
  useKeys(state, change);
  useLayoutEffect(() => publish(stage ?? null, state, setState), [stage, state]);

  // Slow computations wait until the view is at rest.
  const rest = useRest(stage, state, dragging);
  const calm = rest ?? state;
  const worst = useWorst(rest, sources) ?? facingPoint(state);
  const errors = useState<ErrorsOf>(new Map());
  const row = calm.probe ? null : farthestRow(sources, calm, errors[0]);
  const pair = useMemo(() => {
    if (row !== null) return { wo: data.pairs[row]![0], wi: data.pairs[row]![1] };
    const probed = stage && rest?.probe ? stage.pick(...rest.probe, rest) : null;
    return probed && probed.wi[2] > 0 && probed.wo[2] > 0 ? unitPair(probed) : worst;
  }, [stage, rest, row]);
  const measured = useMeasured(stage, pair, state, dragging || rest !== state);
  useErrors(stage, sources, calm, measured, errors);
  const evidence = useEvidence(stage, sources, calm, pair, measured, errors[0]);
  const differ = rest && stage && state.shape === "sphere" ? onSphere(stage, rest, worst) : null;
  const view: ViewProps = { data, sources, state, change };
  // During a drag the picture has priority; numbers are updated afterwards.
  const still = dragging ? calm : state;
  const controls = useMemo(() => {
    const own: ViewProps = { ...view, state: still };
    return (
      <aside class="controls" aria-label="Controls">
        <Material {...own} drawn={rest !== null} />
        <Inputs {...own} />
        <Scene {...own} />
        <Wanted {...own} />
      </aside>
    );
  }, [still, rest !== null]);
  return (
    <>
      <Header data={data} />
      <Dropped {...view} />
      <Materials {...view} />
      <div class="columns">
        <div class="main">
          <Sides {...view} rest={rest} evidence={evidence} />
          <StageView
            {...view}
            mark={state.probe ?? differ}
            onStage={setStage}
            onDrag={setDragging}
          />
        </div>
        {controls}
        <Probe
          {...view}
          calm={calm}
          pair={pair}
          row={row}
          measured={measured}
          able={stage !== null}
          drawn={rest !== null}
        />
      </div>
    </>
  );
}

function Header({ data }: { readonly data: PageData }) {
  const [message, setMessage] = useState("");
  return (
    <header>
      <h1>mxeon explorer</h1>
      <p>Two materials at a time: where they differ, by how much, and which one is right.</p>
      <button
        type="button"
        onClick={() =>
          void copy(location.href).then((done) => setMessage(done ? "Copied" : "See the address"))
        }
      >
        Copy a link to this view
      </button>
      <span class="said" role="status">
        {message}
      </span>
      <small>
        mxeon {data.version}, MaterialX {data.materialx}
      </small>
    </header>
  );
}

/** Synchronize the address with the view, in both directions. */
function useAddress(state: State, setState: (state: State) => void, data: PageData): void {
  useEffect(() => {
    const write = (): void => {
      const address = toAddress(state, data);
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
    const read = (): void => setState(fromAddress(location.hash.slice(1), data));
    addEventListener("hashchange", read);
    return () => removeEventListener("hashchange", read);
  }, []);
}

/** Keyboard shortcuts: F switches the material, and D, S and W choose the comparison. */
function useKeys(state: State, change: (patch: Partial<State>) => void): void {
  useEffect(() => {
    const press = (event: KeyboardEvent): void => {
      const typing = (event.target as Element).matches("input:not([type=radio]), select, textarea");
      if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
      const other = state.shown === "left" ? "right" : "left";
      if (event.key === "f") change({ comparison: "flicker", shown: other });
      if (event.key === "d") change({ comparison: "difference" });
      if (event.key === "w") change({ comparison: "wipe" });
      if (event.key === "s") change({ comparison: "side" });
    };
    addEventListener("keydown", press);
    return () => removeEventListener("keydown", press);
  }, [state.shown]);
}

/** The point where the sides differ most; for one model, where it differs most from Lambert. */
function useWorst(state: State | null, sources: Sources): Point | null {
  return useMemo(() => {
    if (!state) return null;
    const [first, second] = [state.left, state.right].map((side) => {
      const source = sourceOf(sources, side);
      return (
        actualModel(source, side, state) ?? meantModel(source, side, state) ?? model("lambert")
      );
    });
    return worstPoint(first!, second!, state);
  }, [state]);
}

/** Position of a point of the sphere in the picture. */
function onSphere(stage: Stage, state: State, { normal }: Point): [number, number] {
  const { width, height } = stage.size();
  const radius = stage.diameter(state) / 2;
  return [toSide(state, 0.5 + (normal[0] * radius) / width), 0.5 - (normal[1] * radius) / height];
}
