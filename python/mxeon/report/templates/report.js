// SPDX-License-Identifier: Apache-2.0
// Sliders that lay the reference over a picture, and links into folded parts. The page is complete without them.
"use strict";

document.documentElement.classList.add("scripted");

for (const panels of document.querySelectorAll(".panels.referenced")) {
  const reference = panels.querySelector(".reference img");
  for (const figure of panels.querySelectorAll(".image")) {
    const over = reference.cloneNode();
    const slider = document.createElement("input");
    over.className = "over";
    Object.assign(slider, { type: "range", min: 0, max: 100, value: 0 });
    slider.setAttribute("aria-label", "share of the picture that the reference covers");
    slider.addEventListener("input", () => {
      over.style.clipPath = `inset(0 ${100 - slider.value}% 0 0)`;
    });
    over.style.clipPath = "inset(0 100% 0 0)";
    figure.querySelector(".frame").append(over);
    figure.append(slider);
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
