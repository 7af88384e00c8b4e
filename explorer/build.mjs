// SPDX-License-Identifier: Apache-2.0
// Bundles the page into one HTML template, into which Python puts the data.

import { createHash } from "node:crypto";
import { readFile, writeFile } from "node:fs/promises";
import { build } from "esbuild";

const TEMPLATE = "../python/mxeon/explorer/explorer.html";

const { outputFiles } = await build({
  entryPoints: { page: "src/main.tsx" },
  outdir: "out",
  write: false,
  bundle: true,
  minify: true,
  format: "iife",
  target: ["chrome110", "firefox115", "safari16.4"],
  charset: "ascii",
  legalComments: "none",
  loader: { ".glsl": "text" },
});
const text = (suffix) => outputFiles.find((file) => file.path.endsWith(suffix)).text.trim();
const hash = (content) => `'sha256-${createHash("sha256").update(content).digest("base64")}'`;

// Nothing in a script element may end it.
const script = text(".js").replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");
const style = text(".css");
const parts = {
  "%STYLE%": style,
  "%SCRIPT%": script,
  "%STYLE_HASH%": hash(style),
  "%SCRIPT_HASH%": hash(script),
};
let page = await readFile("src/page.html", "utf8");
for (const [mark, part] of Object.entries(parts)) page = page.replace(mark, () => part);
await writeFile(process.argv[2] ?? TEMPLATE, page);
