// SPDX-License-Identifier: Apache-2.0
// Sliders compare two pictures, and links unfold parts. The page is complete without JavaScript.
"use strict";

document.documentElement.classList.add("scripted");

for (const panels of document.querySelectorAll(".panels")) {
  const source = panels.querySelector(".reference img, .pair .image img");
  for (const figure of source ? panels.querySelectorAll(".image") : []) {
    if (figure.contains(source)) continue;
    const over = source.cloneNode();
    const slider = document.createElement("input");
    const label = document.createElement("label");
    over.className = "over";
    Object.assign(slider, { type: "range", min: 0, max: 100, value: 0 });
    slider.addEventListener("input", () => {
      over.style.clipPath = `inset(0 ${100 - slider.value}% 0 0)`;
    });
    over.style.clipPath = "inset(0 100% 0 0)";
    label.append(`Wipe to ${source.closest("figure").querySelector("b").textContent}`, slider);
    figure.querySelector(".frame").append(over);
    figure.append(label);
  }
}

function open() {
  const target = document.getElementById(location.hash.slice(1));
  for (let each = target; each; each = each.parentElement) {
    if (each instanceof HTMLDetailsElement) each.open = true;
  }
}

addEventListener("hashchange", open);
open();
