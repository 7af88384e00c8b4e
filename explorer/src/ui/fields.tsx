// SPDX-License-Identifier: Apache-2.0
// Labeled form fields.

import type { ComponentChildren } from "preact";
import { useId, useRef, useState } from "preact/hooks";
import type { Triple, Vec3 } from "../data";
import { fromHex, toHex } from "../format";

interface NumberProps {
  readonly label: string;
  readonly value: number;
  readonly min?: number;
  readonly max?: number;
  readonly step?: number | "any";
  readonly onChange: (value: number) => void;
}

/** A number field. Text being typed is kept until editing ends, even if other things change. */
export function NumberField({ label, value, min, max, step = "any", onChange }: NumberProps) {
  const [draft, setDraft] = useState<string | null>(null);
  const typed = useRef(false);
  const end = (event: Event): void => {
    const number = (event.currentTarget as HTMLInputElement).valueAsNumber;
    const done = !typed.current || Number.isNaN(number);
    typed.current = false;
    setDraft(null);
    if (done) return;
    onChange(Math.min(Math.max(number, min ?? -Infinity), max ?? Infinity));
  };
  return (
    <input
      type="number"
      aria-label={label}
      {...(min === undefined ? {} : { min })}
      {...(max === undefined ? {} : { max })}
      step={step}
      value={draft ?? Number(value.toPrecision(7))}
      onInput={(event) => {
        typed.current = true;
        setDraft(event.currentTarget.value);
      }}
      onChange={end}
      onBlur={end}
    />
  );
}

interface SliderProps {
  readonly label: string;
  readonly value: number;
  readonly min: number;
  readonly max: number;
  readonly step?: number;
  readonly unit?: string;
  readonly onChange: (value: number) => void;
}

/** A number as a slider with a number field. */
export function Slider({ label, value, min, max, step = 0.01, unit = "", onChange }: SliderProps) {
  const id = useId();
  return (
    <div class="slider">
      <label for={id}>
        {label}
        {unit && <span class="unit"> {unit}</span>}
      </label>
      <input
        id={id}
        type="range"
        {...{ min, max, step }}
        value={Number(value.toPrecision(7))}
        onInput={(event) => onChange(event.currentTarget.valueAsNumber)}
      />
      <NumberField label={`${label}, number`} {...{ value, min, max, onChange }} />
    </div>
  );
}

interface ChoiceProps<T extends string> {
  readonly label: string;
  readonly value: T;
  readonly options: readonly (readonly [T, string])[];
  readonly onChange: (value: T) => void;
}

/** A choice among a few words, which are all visible. */
export function Choice<T extends string>({ label, value, options, onChange }: ChoiceProps<T>) {
  const name = useId();
  return (
    <fieldset class="choice">
      <legend>{label}</legend>
      <div class="segments">
        {options.map(([word, title]) => (
          <label key={word}>
            <input
              type="radio"
              name={name}
              value={word}
              checked={word === value}
              onChange={() => onChange(word)}
            />
            <span>{title}</span>
          </label>
        ))}
      </div>
    </fieldset>
  );
}

interface CheckProps {
  readonly label: ComponentChildren;
  readonly value: boolean;
  readonly onChange: (value: boolean) => void;
}

export function Check({ label, value, onChange }: CheckProps) {
  return (
    <label class="check">
      <input
        type="checkbox"
        checked={value}
        onChange={(event) => onChange(event.currentTarget.checked)}
      />
      <span>{label}</span>
    </label>
  );
}

interface ColorProps {
  readonly label: string;
  readonly value: Vec3;
  readonly onChange: (value: Triple) => void;
}

const CHANNELS = ["red", "green", "blue"] as const;

/** A linear color: a color picker, and a number for each channel. */
export function Color({ label, value, onChange }: ColorProps) {
  const change = (channel: number, number: number): void => {
    const next: Triple = [...value];
    next[channel] = number;
    onChange(next);
  };
  return (
    <fieldset class="color">
      <legend>
        {label}
        <span class="unit"> linear</span>
      </legend>
      <input
        type="color"
        aria-label={`${label}, picker`}
        value={toHex(value)}
        onInput={(event) => onChange(fromHex(event.currentTarget.value))}
      />
      {CHANNELS.map((name, channel) => (
        <NumberField
          key={name}
          label={`${label}, ${name}`}
          min={0}
          max={1}
          step={0.01}
          value={Number(value[channel]!.toFixed(4))}
          onChange={(number) => change(channel, number)}
        />
      ))}
    </fieldset>
  );
}

/** A swatch of a linear color. */
export function Swatch({ color }: { readonly color: Vec3 }) {
  return (
    <svg class="swatch" viewBox="0 0 1 1" aria-hidden="true">
      <rect width="1" height="1" fill={toHex(color)} />
    </svg>
  );
}
