// SPDX-License-Identifier: Apache-2.0
// The two materials: what they are, and the verdict on them.

import type { PageData } from "../data";
import { SAMPLERS, type Sampler, type SideName, type State } from "../state";
import { verdict_on } from "../verdict";
import { has_flag, LETTER, SIDES, source_of, with_source, type Sources } from "../view";
import { useMemo } from "preact/hooks";
import { Check } from "./fields";

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

export function Sides(props: ViewProps) {
  return (
    <section class="sides" aria-label="Materials">
      {SIDES.map((name) => (
        <SideCard key={name} name={name} {...props} />
      ))}
    </section>
  );
}

function SideCard({ name, data, sources, state, change }: ViewProps & { readonly name: SideName }) {
  const side = state[name];
  const source = source_of(sources, side);
  const groups = [...new Set(data.sources.map((each) => each.group))];
  const { azimuth, elevation, color, roughness, inputs } = state;
  const verdict = useMemo(
    () => verdict_on(state, sources, side),
    [side, azimuth, elevation, color, roughness, inputs],
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
          onChange={(event) => change(with_source(state, sources, name, event.currentTarget.value))}
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
      {has_flag(source) && (
        <Check
          label={<code>energy_compensation</code>}
          value={side.flag}
          onChange={(flag) => change({ [name]: { ...side, flag } })}
        />
      )}
      {state.paths && (
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
      <p class={`verdict ${verdict.kind}`}>
        <strong>{verdict.badge}</strong> {verdict.text}
      </p>
      {source.note && <p class="note">{source.note}</p>}
    </div>
  );
}
