// SPDX-License-Identifier: Apache-2.0
// Light, shape, surroundings and path tracing.

import { SHAPES, SURROUNDINGS, type Shape, type Surroundings } from "../state";
import { Check, Choice, Slider } from "./fields";
import type { ViewProps } from "./sides";

const SHAPE_TITLES: Readonly<Record<Shape, string>> = {
  sphere: "sphere",
  plane: "on a plane",
  cloth: "cloth",
  ball: "shader ball",
  fiber: "hair",
};

const SURROUNDINGS_TITLES: Readonly<Record<Surroundings, string>> = {
  none: "black",
  uniform: "white",
  studio: "studio",
  sky: "sky",
  own: "yours",
};

export function Scene({ data, state, change }: ViewProps) {
  return (
    <section>
      <h2>Light and shape</h2>
      <Slider
        label="Light around"
        unit="degrees"
        value={state.azimuth}
        min={-180}
        max={180}
        step={1}
        onChange={(azimuth) => change({ azimuth })}
      />
      <Slider
        label="Light above"
        unit="degrees"
        value={state.elevation}
        min={-90}
        max={90}
        step={1}
        onChange={(elevation) => change({ elevation })}
      />
      <Slider
        label="Light strength"
        value={state.light}
        min={0}
        max={4}
        onChange={(light) => change({ light })}
      />
      <Slider
        label="Exposure"
        unit="stops"
        value={state.exposure}
        min={-4}
        max={4}
        step={0.1}
        onChange={(exposure) => change({ exposure })}
      />
      <Choice
        label="Shape"
        value={state.shape}
        options={SHAPES.map((shape) => [shape, SHAPE_TITLES[shape]] as const)}
        onChange={(shape) => change({ shape })}
      />
      <Choice
        label="Environment"
        value={state.surroundings}
        options={SURROUNDINGS.filter((word) => word !== "own" || data.sky).map(
          (word) => [word, SURROUNDINGS_TITLES[word]] as const,
        )}
        onChange={(surroundings) => change({ surroundings })}
      />
      <Check
        label="Path tracing, with interreflections"
        value={state.paths}
        onChange={(paths) => change({ paths })}
      />
      {state.paths && (
        <Slider
          label="Samples per pixel"
          value={state.samples}
          min={1}
          max={1024}
          step={1}
          onChange={(samples) => change({ samples: Math.round(samples) })}
        />
      )}
    </section>
  );
}
