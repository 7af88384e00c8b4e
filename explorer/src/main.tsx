// SPDX-License-Identifier: Apache-2.0
// Reads the page's data and shows the page.

import { render } from "preact";
import { fromAddress, toAddress } from "./address";
import { App } from "./app";
import { albedoDir, model, rhoFromAlbedo } from "./models/table";
import type { Stage } from "./stage";
import type { State } from "./state";
import { pageData } from "./texts";
import "./style.css";

/** Access for tests and for the browser's console. */
declare global {
  var mxeon: unknown;
}

const models = { albedoDir, model, rhoFromAlbedo };
const data = pageData(document.getElementById("data")!.textContent!);
const hook = {
  data,
  models,
  toAddress: (state: State) => toAddress(state, data),
  fromAddress: (address: string) => fromAddress(address, data),
};

function publish(stage: Stage | null, state: State, show: (state: State) => void): void {
  globalThis.mxeon = { ...hook, stage, state: () => state, show };
}

const page = document.getElementById("page")!;
page.textContent = "";
render(<App data={data} publish={publish} />, page);
