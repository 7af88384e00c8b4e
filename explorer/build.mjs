// SPDX-License-Identifier: Apache-2.0
// Bundles the page into one HTML template, to which Python adds the data.

import { createHash } from "node:crypto";
import { readFile, writeFile } from "node:fs/promises";
import { build } from "esbuild";

const TEMPLATE = "../python/mxeon/explorer/explorer.html";

// Translates GLSL to JavaScript for one channel in float64. Each vec3 is a wo, a wi or a color.
const float64 = (glsl) =>
  glsl
    .replace(/\/\/.*|^#include.*/gm, "")
    .replace(/^#define (\w+) (.+)/gm, "const $1 = $2;")
    .replace(/^(?:float|vec3) (?=\w+\()/gm, "export function ")
    .replace(/\b(?:float|vec3) (?=\w+ =)/g, "let ")
    .replace(/\b(?:float|vec3) (?=\w)|\bvec3(?=\()/g, "")
    .replace(/\b(w[io])\.([xyz])/g, (_, direction, axis) => `${direction}[${"xyz".indexOf(axis)}]`)
    .replace(/\b(abs|max|min|sqrt)(?=\()/g, "Math.$1");
const MODELS = [
  "../genglsl/lib/eon.glsl",
  "../genglsl/sampling/oren_nayar_family.glsl",
  "src/stage/variants.glsl",
];
const models = {
  name: "models",
  setup({ onResolve, onLoad }) {
    onResolve({ filter: /^glsl:models$/ }, ({ path }) => ({ path, namespace: "glsl" }));
    onLoad({ filter: /.*/, namespace: "glsl" }, async () => {
      const texts = await Promise.all(MODELS.map((file) => readFile(file, "utf8")));
      return { contents: texts.map(float64).join("\n") };
    });
  },
};

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
  plugins: [models],
});
const text = (suffix) => outputFiles.find((file) => file.path.endsWith(suffix)).text.trim();
const hash = (content) => `'sha256-${createHash("sha256").update(content).digest("base64")}'`;

// The script must not contain text that ends its element.
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
