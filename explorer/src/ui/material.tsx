// SPDX-License-Identifier: Apache-2.0
// Color and roughness, the resulting albedo, and the color for a wanted albedo.

import { useMemo } from "preact/hooks";
import type { Triple, Vec3 } from "../data";
import { triple } from "../format";
import { albedoAvg, albedoDir, type Model } from "../models/table";
import { actualModel, enter, LETTER, meantModel, SIDES, sourceOf } from "../view";
import { Check, Choice, Color, Slider, Swatch } from "./fields";
import type { ViewProps } from "./sides";

function perChannel(color: Vec3, one: (rho: number) => number): Triple {
  return [one(color[0]), one(color[1]), one(color[2])];
}

/** Color and roughness. Slow albedos wait until the first picture is drawn. */
export function Material({
  sources,
  state,
  change,
  drawn,
}: ViewProps & { readonly drawn: boolean }) {
  const { color, roughness } = state;
  const shown = SIDES.map((name) => sourceOf(sources, state[name]));
  const models = shown.map((source, k) => actualModel(source, state[SIDES[k]!], state));
  const moves = (control: "color" | "roughness"): boolean =>
    shown.some((source) => source.kind === "model" || source.controls[control] !== "");
  if (!moves("color") && !moves("roughness")) return null;
  return (
    <section>
      <h2>Material</h2>
      <Slider
        label="Roughness"
        value={roughness}
        min={0}
        max={1}
        onChange={(value) => change({ roughness: value })}
      />
      <Color
        label="Color entered"
        value={color}
        onChange={(value) => change({ color: value, keep: false })}
      />
      <table class="albedos">
        <caption>Color seen: the resulting albedo</caption>
        <thead>
          <tr>
            <td />
            <th scope="col">seen head-on</th>
            <th scope="col">on average</th>
          </tr>
        </thead>
        <tbody>
          {SIDES.map((name, k) => {
            const of = models[k];
            return (
              <tr key={name} class={name}>
                <th scope="row">{LETTER[name]}</th>
                {!drawn ? (
                  <td colSpan={2}>…</td>
                ) : of ? (
                  <Albedos of={of} color={color} roughness={roughness} />
                ) : (
                  <td colSpan={2}>not a diffuse lobe</td>
                )}
              </tr>
            );
          })}
        </tbody>
      </table>
    </section>
  );
}

interface AlbedosProps {
  readonly of: Model;
  readonly color: Vec3;
  readonly roughness: number;
}

function Albedos({ of, color, roughness }: AlbedosProps) {
  const albedos = useMemo(
    () => [
      perChannel(color, (rho) => albedoDir(of, 1.0, rho, roughness, 24)),
      perChannel(color, (rho) => albedoAvg(of, rho, roughness)),
    ],
    [of, color, roughness],
  );
  return (
    <>
      {albedos.map((albedo, k) => (
        <td key={k}>
          <Swatch color={albedo} />
          {triple(albedo).slice(1, -1)}
        </td>
      ))}
    </>
  );
}

/** The color for a wanted albedo, if the material is one rough diffuse lobe. */
export function Wanted(props: ViewProps) {
  const { sources, state } = props;
  const of = meantModel(sourceOf(sources, state.left), state.left, state);
  return of && <WantedFor {...props} of={of} />;
}

function WantedFor({ state, change, of }: ViewProps & { readonly of: Model }) {
  const { wanted, average, keep, roughness } = state;
  const color = useMemo(
    () => enter(of, wanted, roughness, average),
    [of, wanted, roughness, average],
  );
  const seen = perChannel(color, (rho) =>
    average ? albedoAvg(of, rho, roughness) : albedoDir(of, 1.0, rho, roughness, 24),
  );
  const reached = seen.every((one, channel) => Math.abs(one - wanted[channel]!) < 1e-6);
  return (
    <section class="wanted">
      <h2>Which color to enter?</h2>
      <Color label="To look like" value={wanted} onChange={(value) => change({ wanted: value })} />
      <Choice
        label="Seen"
        value={average ? "average" : "normal"}
        options={[
          ["normal", "head-on"],
          ["average", "on average"],
        ]}
        onChange={(value) => change({ average: value === "average" })}
      />
      <p class="answer">
        <span>
          at roughness {Number(roughness.toFixed(3))}, {of.short}: enter
        </span>
        <output>
          <Swatch color={color} />
          {triple(color)}
        </output>
      </p>
      {!reached && (
        <p class="note">
          Out of reach: at most {triple(seen)} is seen, as {of.short} loses light.
        </p>
      )}
      <Check
        label="Enter it, and keep the color seen while the roughness changes"
        value={keep}
        onChange={(value) => change({ keep: value })}
      />
    </section>
  );
}
