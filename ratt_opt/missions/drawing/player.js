"use strict";
const data = JSON.parse(document.getElementById("mission").textContent);
const canvas = document.getElementById("map"), pen = canvas.getContext("2d");
const slider = document.getElementById("step"), button = document.getElementById("play"), text = document.getElementById("text");
const [x0, x1, y0, y1] = data.view;
const LEFT = 44, BOTTOM = 34, TOP = 8, RIGHT = 8;  // of the frame, in pixels of the page, for the axes
let width = 0, height = 0, scale = 1;
const X = (x) => LEFT + (x - x0) * scale, Y = (y) => height - BOTTOM - (y - y0) * scale;

// The frame is as wide as the page and as high as the action: nothing of it is empty.
function fit() {
  const dots = window.devicePixelRatio || 1;
  width = canvas.clientWidth; scale = (width - LEFT - RIGHT) / (x1 - x0);
  const tallest = Math.max(240, 0.8 * window.innerHeight);
  scale = Math.min(scale, (tallest - TOP - BOTTOM) / (y1 - y0));
  height = Math.round((y1 - y0) * scale + TOP + BOTTOM);
  canvas.style.height = height + "px";
  canvas.width = Math.round(width * dots); canvas.height = Math.round(height * dots);
  pen.setTransform(dots, 0, 0, dots, 0, 0);
}

function ticks(low, high, room) {
  const rough = (high - low) / Math.max(2, Math.floor(room / 60)), power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((s) => s * power >= rough), found = [];
  for (let k = Math.ceil(low / step); k * step <= high; k++) found.push(Number((k * step).toPrecision(12)));
  return found;
}

function axes() {
  const right = X(x1), top = Y(y1), left = X(x0), foot = Y(y0);
  pen.font = "11px sans-serif"; pen.fillStyle = data.colours.ink; pen.lineWidth = 1; pen.setLineDash([]);
  for (const x of ticks(x0, x1, right - left)) {
    pen.strokeStyle = data.colours.grid; pen.beginPath(); pen.moveTo(X(x), foot); pen.lineTo(X(x), top); pen.stroke();
    pen.textAlign = "center"; pen.textBaseline = "top"; pen.fillText(String(x), X(x), foot + 4);
  }
  for (const y of ticks(y0, y1, foot - top)) {
    pen.strokeStyle = data.colours.grid; pen.beginPath(); pen.moveTo(left, Y(y)); pen.lineTo(right, Y(y)); pen.stroke();
    pen.textAlign = "right"; pen.textBaseline = "middle"; pen.fillText(String(y), left - 4, Y(y));
  }
  pen.strokeStyle = data.colours.ink; pen.strokeRect(left, top, right - left, foot - top);
  pen.textAlign = "center"; pen.textBaseline = "bottom"; pen.fillText("x [m]", (left + right) / 2, height - 1);
  pen.save(); pen.translate(10, (top + foot) / 2); pen.rotate(-Math.PI / 2); pen.textBaseline = "middle";
  pen.fillText("y [m]", 0, 0); pen.restore();
}

function counted(number, noun) { return `${number} ${noun}${number === 1 ? "" : "s"}`; }

function line(a, b, colour, dash) {
  pen.strokeStyle = colour; pen.setLineDash(dash); pen.beginPath();
  pen.moveTo(X(a[0]), Y(a[1])); pen.lineTo(X(b[0]), Y(b[1])); pen.stroke(); pen.setLineDash([]);
}

function draw(k) {
  const f = data.frames[k];
  pen.clearRect(0, 0, width, height); axes(); pen.lineWidth = 1;
  for (const [i, j] of f.links) line(f.robots[i], f.robots[j], data.colours.link, []);
  for (const [i, j] of f.cut) line(f.robots[i], f.robots[j], data.colours.cut, [5, 4]);
  (f.fields || []).forEach(([angle, radius], i) => {  // only the rim of one wider than half a turn: it would flood the map
    const [x, y, heading] = f.robots[i], whole = angle >= 2 * Math.PI - 1e-9;
    pen.fillStyle = pen.strokeStyle = data.colours[f.roles[i]]; pen.beginPath();
    if (!whole) pen.moveTo(X(x), Y(y));
    pen.arc(X(x), Y(y), radius * scale, -heading - angle / 2, -heading + angle / 2);
    if (!whole) pen.closePath();
    if (angle <= Math.PI) { pen.globalAlpha = 0.13; pen.fill(); }
    pen.globalAlpha = 0.5; pen.stroke(); pen.globalAlpha = 1;
  });
  f.estimates.forEach((p, j) => {
    const [a, b, angle] = f.ellipses[j];
    pen.fillStyle = data.colours.target; pen.globalAlpha = 0.25; pen.beginPath();
    pen.ellipse(X(p[0]), Y(p[1]), a * scale, b * scale, -angle, 0, 2 * Math.PI); pen.fill(); pen.globalAlpha = 1;
  });
  pen.fillStyle = data.colours.target; pen.textAlign = "center"; pen.textBaseline = "middle";
  f.targets.forEach((p, j) => {
    pen.font = "14px sans-serif"; pen.fillText("★", X(p[0]), Y(p[1]));
    pen.font = "11px sans-serif"; pen.fillText("T" + j, X(p[0]) + 14, Y(p[1]) + 10);
  });
  f.robots.forEach((p, i) => {
    const role = f.roles[i], x = X(p[0]), y = Y(p[1]);
    pen.fillStyle = data.colours[role]; pen.beginPath();
    if (role === "cut off") pen.rect(x - 7, y - 7, 14, 14); else pen.arc(x, y, 8, 0, 2 * Math.PI);
    pen.fill();
    pen.strokeStyle = data.colours.ink; pen.lineWidth = 2; pen.beginPath(); pen.moveTo(x, y);
    pen.lineTo(x + 14 * Math.cos(p[2]), y - 14 * Math.sin(p[2])); pen.stroke();
    if (role === "blinded") {
      pen.beginPath(); pen.moveTo(x - 7, y - 7); pen.lineTo(x + 7, y + 7);
      pen.moveTo(x - 7, y + 7); pen.lineTo(x + 7, y - 7); pen.stroke();
    }
    pen.fillStyle = data.colours.ink; pen.font = "11px sans-serif"; pen.fillText(String(i), x + 12, y - 10);
  });
  const blinded = f.roles.filter((r) => r === "blinded").length;
  text.textContent = `Step ${f.step} of ${data.frames.length}: RMSE ${data.rmse[k].toPrecision(3)} m, ` +
    `NEES ${data.nees[k].toPrecision(3)}; ${counted(blinded, "robot")} blinded, ${counted(f.n_cut, "link")} cut`;
  slider.value = k;
}

let timer = null;
function stop() { clearInterval(timer); timer = null; button.textContent = "Play"; }
button.addEventListener("click", () => {
  if (timer !== null) { stop(); return; }
  button.textContent = "Pause";
  timer = setInterval(() => draw((Number(slider.value) + 1) % data.frames.length), 250);
});
slider.addEventListener("input", () => { stop(); draw(Number(slider.value)); });
let shown = 0;
function refit() { if (canvas.clientWidth !== shown) { shown = canvas.clientWidth; fit(); draw(Number(slider.value)); } }
window.addEventListener("resize", refit);
refit();
