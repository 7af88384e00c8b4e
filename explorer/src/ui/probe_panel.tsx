// SPDX-License-Identifier: Apache-2.0
// The probe shows the values of both sides for a pair of directions, and the errors.

import type { ComponentChild } from "preact";
import { useMemo, useState } from "preact/hooks";
import type { Triple } from "../data";
import { copy, materialX, pythonLine, shaderText } from "../copies";
import type { State } from "../state";
import { degrees, show, signed, triple } from "../format";
import { apart, isOther, type Pair, values } from "../probe";
import { actualModel, LETTER, meantModel, SIDES, sourceOf, tabled } from "../view";
import { AlbedoPlot, type Curve, Polar } from "./plots";
import type { ViewProps } from "./sides";

/** pi f cos of each shader; null while the shader compiles, or if the shader fails. */
export interface Measured {
  readonly left: Triple | null;
  readonly right: Triple | null;
}

interface ProbeProps extends ViewProps {
  readonly calm: State; // the last view at rest, to which the values belong
  readonly pair: Pair;
  readonly row: number | null; // row of the reference tables that belongs to `pair`
  readonly measured: Measured | null; // null during motion or if no shader runs
  readonly able: boolean; // whether shaders run
  readonly drawn: boolean; // whether the first picture is done; plots wait for the picture
}

const DECIMALS = 7;

export function Probe(props: ProbeProps) {
  const { sources, calm, change, pair, row, drawn } = props;
  const { color, roughness, probe } = calm;
  const known = SIDES.some((side) => actualModel(sourceOf(sources, calm[side]), calm[side], calm));
  const plots = useMemo(() => {
    const curves: Curve[] = [];
    for (const side of SIDES) {
      const of = actualModel(sourceOf(sources, calm[side]), calm[side], calm);
      if (of) curves.push({ side, model: of });
    }
    if (!drawn || curves.length === 0) return null;
    return (
      <>
        <Polar {...{ curves, pair, color, roughness }} />
        <AlbedoPlot {...{ curves, pair, color, roughness }} />
      </>
    );
  }, [calm, pair, drawn]);
  return (
    <section class="probe" aria-label="Probe">
      <div>
        <h2>Probe</h2>
        <p class="where">
          {probe
            ? "The clicked point."
            : row !== null
              ? "The sampled directions with the largest error."
              : known
                ? "Where A and B differ most in this light."
                : "A point whose normal is halfway between eye and light."}{" "}
          {probe ? (
            <button type="button" class="link" onClick={() => change({ probe: null })}>
              Go to the largest difference
            </button>
          ) : (
            "Click the picture for another point."
          )}
        </p>
        <Directions pair={pair} />
        <Values {...props} />
        <Copies {...props} />
      </div>
      {plots}
    </section>
  );
}

function Directions({ pair: { wo, wi } }: { readonly pair: Pair }) {
  const azimuth = Math.atan2(wi[1], wi[0]) - Math.atan2(wo[1], wo[0]);
  return (
    <dl class="directions">
      <dt>wo, to the eye</dt>
      <dd>
        {triple(wo, 4)} <span>θ {degrees(Math.acos(wo[2]))}</span>
      </dd>
      <dt>wi, to the light</dt>
      <dd>
        {triple(wi, 4)}{" "}
        <span>
          θ {degrees(Math.acos(wi[2]))}, φ {degrees(Math.abs(azimuth))}
        </span>
      </dd>
    </dl>
  );
}

function Values({ sources, calm: state, pair, row, measured, able }: ProbeProps) {
  const { color, roughness } = state;
  return (
    <table class="values">
      <caption>Value, π f cos θ for red, green, blue</caption>
      <thead>
        <tr>
          <td />
          {SIDES.map((name) => (
            <th key={name} scope="col" class={name}>
              {LETTER[name]}
            </th>
          ))}
        </tr>
      </thead>
      <tbody>
        <Row title="value">
          {SIDES.map((name) => {
            const of = actualModel(sourceOf(sources, state[name]), state[name], state);
            const value = measured?.[name];
            if (!value && able) return <Measuring />;
            if (!value && !of) return "–";
            return (
              <>
                <span class="of">{value ? "shader, float32" : `${of!.short}, float64`}</span>
                <Numbers values={value ?? values(of!, pair, color, roughness)} />
                {value && of && isOther(value, values(of, pair, color, roughness)) && (
                  <strong class="wrong">The shader is not {of.short}.</strong>
                )}
              </>
            );
          })}
        </Row>
        <Row title="reference">
          {SIDES.map((name) => {
            const source = sourceOf(sources, state[name]);
            const of = meantModel(source, state[name], state);
            const should = of ? values(of, pair, color, roughness) : tabled(source, state, row);
            if (!should) return "–";
            return (
              <>
                <span class="of">{of ? of.short : "models"}, float64</span>
                <Numbers values={should} />
              </>
            );
          })}
        </Row>
        <Row title="error">
          {SIDES.map((name) => {
            const source = sourceOf(sources, state[name]);
            const [is, of] = [
              actualModel(source, state[name], state),
              meantModel(source, state[name], state),
            ];
            const should = of ? values(of, pair, color, roughness) : tabled(source, state, row);
            if (!should) return "–";
            if (!measured?.[name] && able) return <Measuring />;
            // If no shader runs, do not compare a model with itself.
            const value =
              measured?.[name] ?? (is && is !== of && values(is, pair, color, roughness));
            if (!value) return "not measured";
            const error = apart(value, should);
            const bound = source.kind === "shader" && !of ? source.reference!.bounds.direct : null;
            const right =
              bound === null
                ? !isOther(value, should)
                : Math.abs(error) <= bound * Math.max(1, ...should);
            return (
              <strong class={right ? "correct" : "wrong"}>
                {signed(error, 2)}{" "}
                {!right
                  ? error > 0
                    ? "too bright"
                    : "too dark"
                  : bound === null
                    ? "✓ rounding"
                    : `≤ ${show(bound * Math.max(1, ...should), 2)}`}
              </strong>
            );
          })}
        </Row>
        <tr>
          <th scope="row">A − B</th>
          <td colSpan={2}>
            {measured?.left && measured.right
              ? signed(apart(measured.left, measured.right), 3)
              : "–"}
          </td>
        </tr>
      </tbody>
    </table>
  );
}

function Measuring() {
  return <span class="of">measuring…</span>;
}

interface RowProps {
  readonly title: string;
  readonly children: readonly ComponentChild[];
}

function Row({ title, children }: RowProps) {
  return (
    <tr>
      <th scope="row">{title}</th>
      {children.map((cell, k) => (
        <td key={k}>{cell}</td>
      ))}
    </tr>
  );
}

function Numbers({ values }: { readonly values: Triple }) {
  return (
    <span class="numbers">
      {values.map((one, k) => (
        <span key={k}>{one.toFixed(DECIMALS).replace("-", "\u2212")}</span>
      ))}
    </span>
  );
}

/** Copy buttons for each side. */
function Copies({ data, sources, state, calm, pair }: ProbeProps) {
  const [message, setMessage] = useState("");
  const take = (what: string, text: string): void => {
    void copy(text).then((done) =>
      setMessage(done ? `${what} copied.` : `${what} cannot be copied here.`),
    );
  };
  return (
    <div class="copies">
      {SIDES.map((name) => {
        const source = sourceOf(sources, state[name]);
        const of = actualModel(sourceOf(sources, calm[name]), calm[name], calm);
        const texts: [string, string | null][] = [
          ["MaterialX", materialX(state, sources, source, state[name])],
          ["GLSL", shaderText(data, source)],
          ["Python", of && pythonLine(of, pair, calm)], // uses the visible values
        ];
        return (
          <p key={name} role="group" aria-label={`Copy from ${LETTER[name]}`}>
            <span>Copy {LETTER[name]}:</span>
            {texts.map(([what, text]) => (
              <button
                key={what}
                type="button"
                disabled={text === null}
                aria-label={`Copy ${LETTER[name]} as ${what}`}
                onClick={() => text !== null && take(`${LETTER[name]}, ${what}`, text)}
              >
                {what}
              </button>
            ))}
          </p>
        );
      })}
      <p class="said" role="status">
        {message}
      </p>
    </div>
  );
}
