// SPDX-License-Identifier: Apache-2.0
// Handles on the picture; each can be moved with the arrow keys, too.

import type { ViewProps } from "./sides";

const STEP = 0.02; // fraction of the picture per arrow key

const ARROWS: Readonly<Record<string, readonly [number, number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

/** Step for an arrow key; null for other keys. */
function arrow(event: KeyboardEvent): readonly [number, number] | null {
  const steps = ARROWS[event.key] ?? null;
  if (steps) event.preventDefault();
  return steps;
}

function clamp(value: number): number {
  return Math.min(Math.max(value, 0), 1);
}

export function WipeHandle({ state, change }: ViewProps) {
  return (
    <div
      class="wipe"
      role="slider"
      tabIndex={0}
      aria-label="Wipe between A and B"
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={Math.round(100 * state.wipe)}
      style={{ left: `${100 * state.wipe}%` }}
      onKeyDown={(event) => {
        const steps = arrow(event);
        if (steps) change({ wipe: clamp(state.wipe + STEP * (steps[0] - steps[1])) });
      }}
    >
      <span />
    </div>
  );
}

interface HandleProps extends ViewProps {
  readonly at: readonly [number, number];
}

/** A handle's position, clamped to the picture. */
function position([x, y]: readonly [number, number]) {
  const inside = (share: number): string => `clamp(16px, ${100 * share}%, 100% - 16px)`;
  return { left: inside(x), top: inside(y) };
}

export function LightHandle({ state, change, at }: HandleProps) {
  const { azimuth, elevation } = state;
  return (
    <button
      type="button"
      class="light"
      aria-label={`Light, ${azimuth.toFixed()} degrees around, ${elevation.toFixed()} above; arrow keys move it`}
      style={position(at)}
      onKeyDown={(event) => {
        const steps = arrow(event);
        if (!steps) return;
        change({
          azimuth: ((azimuth + 5 * steps[0] + 540) % 360) - 180,
          elevation: Math.min(Math.max(elevation - 5 * steps[1], -90), 90),
        });
      }}
    >
      <svg viewBox="-12 -12 24 24" aria-hidden="true">
        <circle r="5" />
        {[0, 45, 90, 135, 180, 225, 270, 315].map((angle) => (
          <line key={angle} x1="8" x2="11" transform={`rotate(${angle})`} />
        ))}
      </svg>
    </button>
  );
}

export function ProbeMark({ change, at }: HandleProps) {
  return (
    <button
      type="button"
      class="mark"
      aria-label="Probe; arrow keys move it"
      style={position(at)}
      onKeyDown={(event) => {
        const steps = arrow(event);
        if (steps)
          change({ probe: [clamp(at[0] + STEP * steps[0]), clamp(at[1] + STEP * steps[1])] });
      }}
    />
  );
}
