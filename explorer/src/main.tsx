// SPDX-License-Identifier: Apache-2.0
// Reads the page's data and shows the page.

import { render } from "preact";
import { from_address, to_address } from "./address";
import { App } from "./app";
import type { PageData } from "./data";
import * as albedo from "./models/albedo";
import * as inversion from "./models/inversion";
import * as table from "./models/table";
import type { Stage } from "./stage";
import type { State } from "./state";
import { page_data } from "./texts";
import "./style.css";

/** Access for tests and for the browser's console. */
interface Hook {
  stage: Stage | null;
  state: () => State;
  show: (state: State) => void;
  readonly data: PageData;
  readonly models: typeof albedo & typeof inversion & typeof table;
  readonly to_address: (state: State) => string;
  readonly from_address: (address: string) => State;
}

declare global {
  var mxeon: Hook | undefined;
}

const data = page_data(document.getElementById("data")!.textContent!);
const hook = {
  data,
  models: { ...albedo, ...inversion, ...table },
  to_address: (state: State) => to_address(state, data),
  from_address: (address: string) => from_address(address, data),
};

function tell(stage: Stage | null, state: State, show: (state: State) => void): void {
  globalThis.mxeon = { ...hook, stage, state: () => state, show };
}

const page = document.getElementById("page")!;
page.textContent = "";
render(<App data={data} tell={tell} />, page);
