// SPDX-License-Identifier: Apache-2.0
// The inputs of a document, with the ranges of their definitions.

import type { Port, ShaderSource, Triple } from "../data";
import type { State, Value } from "../state";
import { SIDES, sourceOf, stemOf, valuesOf } from "../view";
import { Check, Color, NumberField, Slider } from "./fields";
import type { ViewProps } from "./sides";

/** Controls of the visible documents, one group for both libraries of a material. */
export function Inputs(props: ViewProps) {
  const { sources, state } = props;
  const shown = new Map<string, ShaderSource>();
  for (const name of SIDES) {
    const source = sourceOf(sources, state[name]);
    if (source.kind === "shader" && !source.id.startsWith("shader/")) {
      const stem = stemOf(source.id);
      if (!shown.has(stem)) shown.set(stem, source);
    }
  }
  return (
    <>
      {[...shown.values()].map((source) => (
        <Group key={source.id} source={source} {...props} />
      ))}
    </>
  );
}

function Group({ source, data, state, change }: ViewProps & { readonly source: ShaderSource }) {
  const side = SIDES.map((name) => state[name]).find((each) => each.source === source.id)!;
  const values = valuesOf(source, state, side);
  const own = new Set(Object.values(source.controls));
  const twins = data.sources.filter((each) => stemOf(each.id) === stemOf(source.id));
  const set = (port: Port, value: Value): void => {
    const inputs: Record<string, State["inputs"][string]> = { ...state.inputs };
    for (const { id } of twins) inputs[id] = { ...inputs[id], [port.name]: value };
    change({ inputs });
  };
  const ports = source.inputs.filter((port) => port.shown && !own.has(port.name));
  if (ports.length === 0) return null;
  return (
    <section>
      <h2>Inputs of {source.title.replace(/, [^,]*$/, "")}</h2>
      {ports.map((port) => (
        <Field
          key={port.name}
          port={port}
          alone={ports.every((each) => each === port || each.label !== port.label)}
          value={values.get(port.name)!}
          onChange={(value) => set(port, value)}
        />
      ))}
    </section>
  );
}

interface FieldProps {
  readonly port: Port;
  readonly alone: boolean; // whether the label is unique, so that the node's name is not shown
  readonly value: Value;
  readonly onChange: (value: Value) => void;
}

function Field({ port, alone, value, onChange }: FieldProps) {
  const node = port.path.split("/").slice(-2, -1)[0];
  const label = node && !alone ? `${node.replaceAll("_", " ")}: ${port.label}` : port.label;
  if (typeof value === "boolean") return <Check label={label} value={value} onChange={onChange} />;
  if (typeof value === "number") {
    const [min, max] = range(port, value);
    const step = port.type === "integer" ? 1 : (max - min) / 200;
    return <Slider label={label} {...{ value, min, max, step, onChange }} />;
  }
  // Color ranges end at 1. Inputs with larger values, such as indices of refraction, are no colors.
  if (port.type === "color3" && Math.max(...(port.value as Triple)) <= 1) {
    return <Color label={label} value={value as Triple} onChange={onChange} />;
  }
  const [first, second] = value;
  if (port.type === "vector2" && port.label.startsWith("roughness") && first === second) {
    return (
      <Slider label={label} value={first!} min={0} max={1} onChange={(x) => onChange([x, x])} />
    );
  }
  return (
    <fieldset class="parts">
      <legend>{label}</legend>
      {value.map((part, k) => (
        <NumberField
          key={k}
          label={`${label}, part ${k + 1}`}
          value={part}
          onChange={(number) => onChange(value.map((one, n) => (n === k ? number : one)))}
        />
      ))}
    </fieldset>
  );
}

/** The range of a number's slider: the one its definition recommends, or one around its value. */
function range(port: Port, value: number): [number, number] {
  const own = typeof port.value === "number" ? port.value : value;
  return [port.min ?? Math.min(0, 2 * own), port.max ?? (own > 1 ? 2 * own : 1)];
}
