"use strict";
const data = JSON.parse(document.getElementById("mission").textContent);
const canvas = document.getElementById("map"), pen = canvas.getContext("2d");
const slider = document.getElementById("step"), button = document.getElementById("play"), text = document.getElementById("text");
const [x0, x1, y0, y1] = data.view, size = canvas.width;
const scale = size / Math.max(x1 - x0, y1 - y0);
const X = (x) => (x - x0) * scale, Y = (y) => size - (y - y0) * scale;

function counted(number, noun) { return `${number} ${noun}${number === 1 ? "" : "s"}`; }

function line(a, b, colour, dash) {
  pen.strokeStyle = colour; pen.setLineDash(dash); pen.beginPath();
  pen.moveTo(X(a[0]), Y(a[1])); pen.lineTo(X(b[0]), Y(b[1])); pen.stroke(); pen.setLineDash([]);
}

function draw(k) {
  const f = data.frames[k];
  pen.clearRect(0, 0, size, size); pen.lineWidth = 1;
  for (const [i, j] of f.links) line(f.robots[i], f.robots[j], data.colours.link, []);
  for (const [i, j] of f.cut) line(f.robots[i], f.robots[j], data.colours.cut, [5, 4]);
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
draw(0);
