"use strict";
// All places were computed beforehand, for both scales of both axes: this picks among them.
const tip = document.getElementById("tip");

function draw(figure) {
  const svg = figure.querySelector("svg");
  const x = svg.dataset.x, y = svg.dataset.y;
  for (const [name, scale] of [["x", x], ["y", y]])
    for (const axis of svg.querySelectorAll(".axis." + name))
      axis.classList.toggle("off", axis.dataset.scale !== scale);
  for (const series of svg.querySelectorAll(".series")) {
    const list = name => (series.dataset[name] || "").split(" ");
    const xs = list("x" + x), ys = list("y" + y), lows = list("low" + y), highs = list("high" + y);
    const there = i => xs[i] !== "-" && ys[i] !== "-";
    const all = [...xs.keys()].filter(there);
    const line = series.querySelector(".line"), interval = series.querySelector(".interval");
    if (line) line.setAttribute("points", all.map(i => xs[i] + "," + ys[i]).join(" "));
    if (interval) {
      const sure = all.filter(i => lows[i] !== "-");
      interval.setAttribute("d", sure.map(i => "M" + xs[i] + " " + lows[i] + "V" + highs[i]).join(""));
    }
    series.querySelectorAll(".mark").forEach((mark, i) => {
      mark.classList.toggle("off", !there(i));
      if (there(i)) mark.setAttribute("transform", "translate(" + xs[i] + " " + ys[i] + ")");
    });
  }
}

for (const figure of document.querySelectorAll("figure")) {
  const svg = figure.querySelector("svg");
  const controls = figure.querySelector(".controls");
  if (controls) {
    controls.hidden = false;
    for (const box of controls.querySelectorAll("input")) {
      const axis = box.dataset.axis;
      box.checked = svg.dataset[axis] === "1";
      box.disabled = !svg.querySelector(".axis." + axis + "[data-scale='1']");
      box.onchange = () => { svg.dataset[axis] = box.checked ? "1" : "0"; draw(figure); };
    }
  }
  for (const key of svg.querySelectorAll(".key")) {
    const series = svg.querySelector(".series[data-series='" + key.dataset.series + "']");
    const toggle = () => {
      const hidden = series.classList.toggle("hidden");
      key.classList.toggle("hidden", hidden);
      key.setAttribute("aria-pressed", String(!hidden));
    };
    for (const [name, value] of [["role", "button"], ["tabindex", "0"], ["aria-pressed", "true"]]) key.setAttribute(name, value);
    key.onclick = toggle;
    key.onkeydown = event => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); toggle(); } };
  }
  // Values at once, and where there is no mouse to rest.
  for (const title of svg.querySelectorAll(".mark > title, .cell > title")) {
    const shape = title.parentNode;
    shape.dataset.tip = title.textContent;
    title.remove();
  }
  const show = event => {
    const told = event.target.dataset && event.target.dataset.tip;
    tip.hidden = !told;
    if (!told) return;
    tip.textContent = told;
    const left = Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 8);
    const top = Math.min(event.clientY + 14, innerHeight - tip.offsetHeight - 8);
    tip.style.left = Math.max(left, 4) + "px";
    tip.style.top = Math.max(top, 4) + "px";
  };
  svg.addEventListener("pointermove", show);
  svg.addEventListener("pointerdown", show);
  svg.addEventListener("pointerleave", () => { tip.hidden = true; });
}
