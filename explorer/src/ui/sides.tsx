// SPDX-License-Identifier: Apache-2.0
// The two materials and the verdicts on them.

import { useMemo } from "preact/hooks";
import type { PageData } from "../data";
import { SAMPLERS, type Sampler, type SideName, type State } from "../state";
import { type Evidence, type Verdict, verdictOn } from "../verdict";
import {
  hasFlag,
  LETTER,
  materialsOf,
  SIDES,
  sourceOf,
  stemOf,
  withMaterial,
  withSource,
  type Sources,
} from "../view";
import { Check, Choice } from "./fields";

export interface ViewProps {
  readonly data: PageData;
  readonly sources: Sources;
  readonly state: State;
  readonly change: (patch: Partial<State>) => void;
}

const SAMPLER_TITLES: Readonly<Record<Sampler, string>> = {
  exact: "exact sampling",
  cltc: "CLTC sampling",
  cosine: "cosine sampling",
};

/** Selects the material to compare, which both libraries draw. */
export function Materials({ data, sources, state, change }: ViewProps) {
  const materials = materialsOf(data);
  const stem = stemOf(state.left.source);
  return (
    <section class="materials" aria-label="What to compare">
      <Choice
        label="eonlib and stock MaterialX"
        value={stem}
        options={[...materials].map(([key, title]) => [key, title] as const)}
        onChange={(key) => change(withMaterial(state, sources, key))}
      />
    </section>
  );
}

interface SidesProps extends ViewProps {
  readonly rest: State | null; // the view that was judged; null before the first picture
  readonly evidence: Readonly<Record<SideName, Evidence>>;
}

export function Sides(props: SidesProps) {
  return (
    <section class="sides" aria-label="Materials">
      {SIDES.map((name) => (
        <SideCard key={name} name={name} {...props} />
      ))}
    </section>
  );
}

const WAITING: Verdict = { kind: "measuring", badge: "measuring", text: "" };

function SideCard(props: SidesProps & { readonly name: SideName }) {
  const { name, data, sources, state, rest, evidence, change } = props;
  const side = state[name];
  const source = sourceOf(sources, side);
  const groups = [...new Set(data.sources.map((each) => each.group))];
  const { able, confirmed, errors, failure } = evidence[name];
  // During motion, keep the last verdict if the material is still the same.
  const judged = rest && rest[name] === side ? rest : null;
  const verdict = useMemo(
    () => (judged ? verdictOn(judged, sources, side, evidence[name]) : WAITING),
    [judged, side, able, confirmed, errors, failure],
  );
  return (
    <div class={`side ${name}`}>
      <label class="source">
        <span class="letter" aria-hidden="true">
          {LETTER[name]}
        </span>
        <span class="hidden">Material {LETTER[name]}</span>
        <select
          value={side.source}
          onChange={(event) => change(withSource(state, sources, name, event.currentTarget.value))}
        >
          {groups.map((group) => (
            <optgroup key={group} label={group}>
              {data.sources
                .filter((each) => each.group === group)
                .map((each) => (
                  <option key={each.id} value={each.id}>
                    {each.title}
                  </option>
                ))}
            </optgroup>
          ))}
        </select>
      </label>
      <p class={`verdict ${verdict.kind}`}>
        <strong>{verdict.badge}</strong> {verdict.text}
      </p>
      <div class="foot">
        <Pages names={source.pages} pattern={data.pages} />
        {hasFlag(source) && (
          <Check
            label={<code>energy_compensation</code>}
            value={side.flag}
            onChange={(flag) => change({ [name]: { ...side, flag } })}
          />
        )}
      </div>
      {state.paths && !(source.kind === "shader" && source.paths) && (
        <label class="sampler">
          <span>Samples</span>
          <select
            value={side.sampler}
            onChange={(event) =>
              change({ [name]: { ...side, sampler: event.currentTarget.value as Sampler } })
            }
          >
            {SAMPLERS.map((sampler) => (
              <option key={sampler} value={sampler}>
                {SAMPLER_TITLES[sampler]}
              </option>
            ))}
          </select>
        </label>
      )}
    </div>
  );
}

interface PagesProps {
  readonly names: readonly string[];
  readonly pattern: string;
}

/** The pages about the defects of a material, as links if their addresses are known. */
function Pages({ names, pattern }: PagesProps) {
  if (names.length === 0) return null;
  return (
    <p class="note pages">
      {names.length === 1 ? "Known defect: " : "Known defects: "}
      {names.map((name, k) => {
        const words = name.replace(/^gen[a-z]+_/, "").replaceAll("_", " ");
        return (
          <>
            {k > 0 && ", "}
            {pattern ? <a href={pattern.replace("{}", name)}>{words}</a> : words}
          </>
        );
      })}
    </p>
  );
}
