// SPDX-License-Identifier: Apache-2.0
// Files dropped on the page. If `mxeon explore` serves the page, the command generates and judges
// the shaders. Any other page shows the command to run.

import { useEffect, useState } from "preact/hooks";
import { stemOf, withMaterial } from "../view";
import type { ViewProps } from "./sides";

const DOCUMENT = /\.mtlx$/i;
const LIGHT = /\.(hdr|exr)$/i;

export function Dropped({ data, sources, state, change }: ViewProps) {
  const [message, setMessage] = useState(data.warnings.join(" "));
  useEffect(() => {
    // Otherwise the browser opens the file.
    const over = (event: DragEvent): void => event.preventDefault();
    const drop = (event: DragEvent): void => {
      event.preventDefault();
      void filesOf(event.dataTransfer).then(shown);
    };
    const shown = async (files: ReadonlyMap<string, File>): Promise<void> => {
      const names = [...files.keys()];
      const first =
        names.find((name) => DOCUMENT.test(name)) ?? names.find((name) => LIGHT.test(name));
      if (names.length === 0) return;
      if (!first)
        return setMessage(
          `${names[0]}: drop a .mtlx document with its images, or a .hdr or .exr map.`,
        );
      if (data.served) {
        setMessage(`${first}: generating its shaders…`);
        return setMessage(await sent(files, DOCUMENT.test(first)));
      }
      const own = data.sources.find(
        ({ id, group }) => id.startsWith("document/") && group === first,
      );
      const option = DOCUMENT.test(first) ? "" : "--environment ";
      setMessage(own ? "" : `To see ${first}, run: mxeon explore ${option}FILE`);
      if (own) change(withMaterial(state, sources, stemOf(own.id)));
    };
    addEventListener("dragover", over);
    addEventListener("drop", drop);
    return () => {
      removeEventListener("dragover", over);
      removeEventListener("drop", drop);
    };
  }, [state]);
  if (!message) return null;
  return (
    <p class="dropped" role="status">
      {message}{" "}
      <button type="button" aria-label="Close" onClick={() => setMessage("")}>
        ×
      </button>
    </p>
  );
}

/** Dropped files and files in dropped folders, by path, because documents name images by path. */
async function filesOf(dropped: DataTransfer | null): Promise<Map<string, File>> {
  const files = new Map<string, File>();
  const add = async (entry: FileSystemEntry): Promise<void> => {
    if (entry.isFile) {
      const file = await new Promise<File>((...ends) =>
        (entry as FileSystemFileEntry).file(...ends),
      );
      files.set(entry.fullPath.slice(1), file);
      return;
    }
    const reader = (entry as FileSystemDirectoryEntry).createReader();
    const read = () => new Promise<FileSystemEntry[]>((...ends) => reader.readEntries(...ends));
    for (let some = await read(); some.length > 0; some = await read()) {
      for (const each of some) await add(each);
    }
  };
  // Read all items before the first await, after which the browser clears the list.
  const items = [...(dropped?.items ?? [])].map(
    (item) => [item.webkitGetAsEntry(), item.getAsFile()] as const,
  );
  for (const [entry, file] of items) {
    if (entry) await add(entry);
    else if (file) files.set(file.name, file);
  }
  return files;
}

/** Send files, documents last, and load the page that shows them; returns the error, if any. */
async function sent(files: ReadonlyMap<string, File>, documents: boolean): Promise<string> {
  const last = ([name]: [string, File]): number => Number(DOCUMENT.test(name));
  for (const [name, file] of [...files].sort((a, b) => last(a) - last(b))) {
    const kind = !documents && LIGHT.test(name) ? "light" : "files";
    const path = `/${kind}/${name.split("/").map(encodeURIComponent).join("/")}`;
    const reply = await fetch(path, { method: "PUT", body: file }).catch(() => null);
    if (!reply) return "mxeon explore has ended: start it again.";
    if (!reply.ok) return reply.text();
  }
  history.replaceState(null, "", location.pathname); // the old address belonged to another material
  location.reload();
  return "";
}
