"use strict";
for (const button of document.querySelectorAll("input[name=view]"))
  button.addEventListener("change", () => {
    for (const view of document.querySelectorAll(".view")) view.hidden = view.id !== "view-" + button.value;
  });
const hint = document.getElementById("hint");
for (const mark of document.querySelectorAll("g[tabindex]"))
  for (const kind of ["mouseenter", "focus"])
    mark.addEventListener(kind, () => { hint.textContent = mark.getAttribute("aria-label"); });
