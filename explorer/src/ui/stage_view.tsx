// SPDX-License-Identifier: Apache-2.0
// The picture with its handles: wipe, light and probe.

import { useEffect, useRef, useState } from "preact/hooks";
import { show, signed } from "../format";
import { type Stage, type Status, createStage } from "../stage";
import { DIFFERENCE_COLORS } from "../stage/colors";
import { COMPARISONS, type Comparison, type State, ZOOMS } from "../state";
import { LETTER, shortTitle, SIDES, sourceOf } from "../view";
import { Choice, Slider } from "./fields";
import { LightHandle, ProbeMark, WipeHandle } from "./handles";
import type { ViewProps } from "./sides";

interface StageViewProps extends ViewProps {
  /** Position of the probe in the picture, [0, 1]^2 from the top left; null without a probe. */
  readonly mark: readonly [number, number] | null;
  readonly onStage: (stage: Stage | null) => void;
  readonly onDrag: (dragging: boolean) => void;
}

const TITLES: Readonly<Record<Comparison, string>> = {
  wipe: "Wipe",
  side: "Side by side",
  difference: "Difference",
  flicker: "Flicker",
};
const NEAR = 18; // distance in pixels within which the line can be grabbed
const DEGREES = 0.4; // degrees that the viewer turns per pixel
const CLICK = 4; // pixels that the pointer may move during a click

/** A position rounded to the digits that the address stores. */
function short([x, y]: readonly [number, number]): [number, number] {
  return [Number(x.toFixed(4)), Number(y.toFixed(4))];
}

/** The view after the pointer moved by some pixels. The subject follows the pointer. */
function turned({ turn, tilt }: State, x: number, y: number): Partial<State> {
  return {
    turn: ((turn - DEGREES * x + 540) % 360) - 180,
    tilt: Math.min(Math.max(tilt + DEGREES * y, -90), 90),
  };
}

type Drag = { kind: "wipe" | "light" | "viewer" | "click"; x: number; y: number } | null;

export function StageView(props: StageViewProps) {
  const { data, sources, state, change, mark, onStage, onDrag } = props;
  const canvas = useRef<HTMLCanvasElement>(null);
  const [stage, setStage] = useState<Stage | null | undefined>(undefined);
  const [status, setStatus] = useState<Status | null>(null);
  const [dragging, setDragging] = useState(false);
  const drag = useRef<Drag>(null);

  useEffect(() => {
    const made = createStage(canvas.current!, data);
    made?.onStatus(setStatus);
    setStage(made);
    onStage(made);
    return () => made?.dispose();
  }, []);
  useEffect(() => stage?.draw(state, dragging), [stage, state, dragging]);
  useEffect(() => onDrag(dragging), [dragging]);

  /** The pointer's position in the picture. */
  const place = (event: PointerEvent): [number, number] => {
    const frame = canvas.current!.getBoundingClientRect();
    return [
      Math.min(Math.max((event.clientX - frame.left) / frame.width, 0), 1),
      Math.min(Math.max((event.clientY - frame.top) / frame.height, 0), 1),
    ];
  };
  const down = (event: PointerEvent): void => {
    if (event.button !== 0) return;
    const { width } = canvas.current!.getBoundingClientRect();
    const [x] = place(event);
    const onLine = state.comparison === "wipe" && Math.abs(x - state.wipe) * width < NEAR;
    const onLight = (event.target as Element).closest(".light");
    const kind = onLight ? "light" : onLine ? "wipe" : "click";
    drag.current = { kind, x: event.clientX, y: event.clientY };
    (event.currentTarget as Element).setPointerCapture(event.pointerId);
  };
  const move = (event: PointerEvent): void => {
    const now = drag.current;
    if (!now) return;
    const far = Math.hypot(event.clientX - now.x, event.clientY - now.y) > CLICK;
    if (now.kind === "click" && far) now.kind = state.shape === "sphere" ? "light" : "viewer";
    if (now.kind === "click") return;
    setDragging(true);
    const [x, y] = place(event);
    if (now.kind === "wipe") change({ wipe: short([x, y])[0] });
    else if (now.kind === "light") change(stage?.toLight(x, y, state) ?? {});
    else {
      change(turned(state, event.clientX - now.x, event.clientY - now.y));
      [now.x, now.y] = [event.clientX, event.clientY];
    }
  };
  const wheel = (event: WheelEvent): void => {
    if (state.shape === "sphere") return;
    event.preventDefault();
    const zoom = state.zoom * Math.exp(-Math.sign(event.deltaY) * 0.1);
    change({ zoom: Math.min(Math.max(Number(zoom.toFixed(3)), ZOOMS[0]), ZOOMS[1]) });
  };
  const end = (): void => {
    drag.current = null;
    setDragging(false);
  };
  const up = (event: PointerEvent): void => {
    if (drag.current?.kind === "click") change({ probe: short(place(event)) });
    end();
  };

  if (stage === null) {
    return (
      <section class="stage" aria-label="Picture">
        <p role="alert">This browser has no WebGL2, so nothing can be drawn. All numbers work.</p>
      </section>
    );
  }
  const names = SIDES.map((name) => shortTitle(sourceOf(sources, state[name]), state[name]));
  return (
    <section class="stage" aria-label="Picture">
      <Toolbar {...props} />
      <div
        class="picture"
        onPointerDown={down}
        onPointerMove={move}
        onPointerUp={up}
        onPointerCancel={end}
        onWheel={wheel}
      >
        <canvas
          ref={canvas}
          role="img"
          aria-label={`Picture of ${names.map((name, k) => `${"AB"[k]}: ${name}`).join("; ")}`}
        />
        <Labels state={state} names={names} />
        {state.comparison === "side" && <span class="split" aria-hidden="true" />}
        {state.comparison === "wipe" && <WipeHandle {...props} />}
        {stage && <LightHandle {...props} at={stage.fromLight(state)} />}
        {mark && <ProbeMark {...props} at={mark} />}
        <StatusLine status={status} />
      </div>
      {state.comparison === "difference" ? (
        <Legend {...props} />
      ) : (
        <p class="hint">
          {state.comparison === "wipe" && "Drag the line to compare. "}
          {state.shape === "sphere"
            ? "Drag anywhere else to move the light."
            : "Drag to look around, scroll to zoom, drag the sun to move the light."}{" "}
          Click to probe.
        </p>
      )}
    </section>
  );
}

function Toolbar({ state, change }: ViewProps) {
  const other = state.shown === "left" ? "right" : "left";
  return (
    <div class="toolbar">
      <Choice
        label="Compare"
        value={state.comparison}
        options={COMPARISONS.map((word) => [word, TITLES[word]] as const)}
        onChange={(comparison) => change({ comparison })}
      />
      {state.comparison === "flicker" && (
        <button type="button" class="flip" onClick={() => change({ shown: other })}>
          Show {LETTER[other]} <kbd>F</kbd>
        </button>
      )}
    </div>
  );
}

/** Labels of the materials. */
function Labels({ state, names }: { readonly state: State; readonly names: readonly string[] }) {
  if (state.comparison === "difference") return null;
  const edge = state.comparison === "side" ? 0.5 : state.wipe;
  return (
    <>
      {SIDES.map((name, k) => {
        const seen =
          state.comparison === "flicker"
            ? state.shown === name
            : name === "left"
              ? edge > 0.1
              : edge < 0.9;
        return (
          seen && (
            <span key={name} class={`label ${name}`} aria-hidden="true">
              <b>{LETTER[name]}</b> {names[k]}
            </span>
          )
        );
      })}
    </>
  );
}

function StatusLine({ status }: { readonly status: Status | null }) {
  return (
    <p class="status" role="status">
      {status && statusText(status)}
    </p>
  );
}

function statusText(status: Status): string {
  switch (status.kind) {
    case "drawn":
    case "restored":
      return "";
    case "compiling":
      return "Compiling the shader…";
    case "samples": {
      const noise = status.noise;
      const words = noise
        ? `, noise A ${show(100 * noise.left, 2)} %, B ${show(100 * noise.right, 2)} %`
        : "";
      return `${status.done} of ${status.of} samples${words}`;
    }
    case "error":
      return status.message;
    case "lost":
      return "The browser lost the graphics context; the picture will come back.";
  }
}

/** The scale of the difference map. */
function Legend({ state, change }: ViewProps) {
  const stops = DIFFERENCE_COLORS.map((color, k) => {
    const codes = color.map((each) => Math.round(255 * each)).join(" ");
    return (
      <stop key={k} offset={k / (DIFFERENCE_COLORS.length - 1)} stop-color={`rgb(${codes})`} />
    );
  });
  return (
    <div class="legend">
      <svg viewBox="0 0 100 6" preserveAspectRatio="none" aria-hidden="true">
        <defs>
          <linearGradient id="difference">{stops}</linearGradient>
        </defs>
        <rect width="100" height="6" fill="url(#difference)" />
      </svg>
      <p>
        <span>{signed(-state.scale)}, B brighter</span>
        <span>0</span>
        <span>{signed(state.scale)}, A brighter</span>
      </p>
      <Slider
        label="Scale"
        unit="powers of ten"
        value={Math.log10(state.scale)}
        min={-8}
        max={1}
        step={0.1}
        onChange={(power) => change({ scale: Number((10 ** power).toPrecision(4)) })}
      />
    </div>
  );
}
