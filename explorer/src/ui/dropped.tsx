// SPDX-License-Identifier: Apache-2.0
// What becomes of a file that is dropped on the page: it is shown if the page has it, and otherwise
// the command that makes a page of it is said. A shader generator does not run here.

import { useEffect, useState } from "preact/hooks";
import { copy } from "../copies";
import { with_material, stem_of } from "../view";
import type { ViewProps } from "./sides";

export function Dropped({ data, sources, state, change }: ViewProps) {
  const [name, setName] = useState("");
  const [said, say] = useState("");
  useEffect(() => {
    const over = (event: DragEvent): void => event.preventDefault(); // or the browser opens the file
    const drop = (event: DragEvent): void => {
      event.preventDefault();
      const file = event.dataTransfer?.files[0];
      if (!file) return;
      const own = data.sources.find(
        ({ id, group }) => id.startsWith("document/") && group === file.name,
      );
      if (own) change(with_material(state, sources, stem_of(own.id)));
      setName(own ? "" : file.name);
      say("");
    };
    addEventListener("dragover", over);
    addEventListener("drop", drop);
    return () => {
      removeEventListener("dragover", over);
      removeEventListener("drop", drop);
    };
  }, [state]);
  if (!name) return null;
  const command = command_for(name);
  return (
    <p class="dropped" role="status">
      {command ? (
        <>
          A page of {name} is made by <code>{command}</code>{" "}
          <button
            type="button"
            onClick={() => void copy(command).then((done) => say(done ? "Copied" : "Not copied"))}
          >
            Copy
          </button>{" "}
          <span class="said">{said}</span>
        </>
      ) : (
        `${name} is no MaterialX document: its name does not end in .mtlx.`
      )}{" "}
      <button type="button" aria-label="Close" onClick={() => setName("")}>
        ×
      </button>
    </p>
  );
}

/** The command that makes a page of a document; "" for another file. */
function command_for(name: string): string {
  if (!name.toLowerCase().endsWith(".mtlx")) return "";
  const path = name.startsWith("-") ? `./${name}` : name; // no option
  const file = /^[\w./-]+$/.test(path) ? path : `'${path.replaceAll("'", `'\\''`)}'`;
  return `mxeon explore ${file} --output page.html`;
}
