// SPDX-License-Identifier: Apache-2.0
// Reads the page's data and shows the page.

import { render } from "preact";
import { App } from "./app";
import type { PageData } from "./data";
import * as albedo from "./models/albedo";
import * as inversion from "./models/inversion";
import * as table from "./models/table";
import type { Stage } from "./stage";
import type { State } from "./state";
import "./style.css";

/** What tests and consoles may use. */
interface Hook {
  stage: Stage | null;
  state: () => State;
  show: (state: State) => void;
  readonly data: PageData;
  readonly models: typeof albedo & typeof inversion & typeof table;
}

declare global {
  var mxeon: Hook | undefined;
}

const data = JSON.parse(document.getElementById("data")!.textContent!) as PageData;
const models = { ...albedo, ...inversion, ...table };

function tell(stage: Stage | null, state: State, show: (state: State) => void): void {
  globalThis.mxeon = { stage, state: () => state, show, data, models };
}

const page = document.getElementById("page")!;
page.textContent = "";
render(<App data={data} tell={tell} />, page);
