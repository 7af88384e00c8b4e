// SPDX-License-Identifier: Apache-2.0
// Sorts and filters the rows. The page is complete without JavaScript.
"use strict";

document.documentElement.classList.add("scripted");

const table = document.querySelector(".field");
const body = table.tBodies[0];
const rows = [...body.rows];
const inputs = [...document.querySelectorAll(".filters input, .filters select")];

function filter() {
  const values = Object.fromEntries(inputs.map((input) => [input.name, input.value]));
  const words = values.words.toLowerCase().split(" ");
  for (const row of rows) {
    const text = row.textContent.toLowerCase();
    row.hidden =
      (values.claimed && row.dataset.claimed !== values.claimed) ||
      (values.verdict && row.dataset.verdict !== values.verdict) ||
      !words.every((word) => text.includes(word));
  }
  for (const figure of document.querySelectorAll("[data-row]")) {
    figure.hidden = document.getElementById(figure.dataset.row).hidden;
  }
  const visible = rows.filter((row) => !row.hidden).length;
  document.querySelector("[role=status]").textContent = `${visible} of ${rows.length} rows`;
}

function key(row, column) {
  const cell = row.cells[column];
  return cell.dataset.order === undefined ? cell.textContent.trim() : Number(cell.dataset.order);
}

function sort(header, column) {
  const rising = header.getAttribute("aria-sort") !== "ascending";
  for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
  header.setAttribute("aria-sort", rising ? "ascending" : "descending");
  const order = (a, b) => (a < b ? -1 : Number(a > b));
  const sorted = rows.toSorted((a, b) => order(key(a, column), key(b, column)));
  body.append(...(rising ? sorted : sorted.toReversed()));
}

for (const [column, header] of [...table.tHead.rows[0].cells].entries()) {
  const button = document.createElement("button");
  button.type = "button";
  button.append(...header.childNodes);
  button.addEventListener("click", () => sort(header, column));
  header.append(button);
}
for (const input of inputs) input.addEventListener("input", filter);
filter();
