// SPDX-License-Identifier: Apache-2.0
// The convergence of the chosen methods on the chosen problem, after page.js, whose names it uses.
const svg_name = "http://www.w3.org/2000/svg";
function draw(parent, name, attributes, text) {
  const element = document.createElementNS(svg_name, name);
  for (const key in attributes) element.setAttribute(key, attributes[key]);
  if (known(text)) element.textContent = text;
  parent.appendChild(element);
  return element;
}

// Markers by style: dot, square, triangle, diamond, triangle, ring, plus, cross; as in the profiles.
const ring = (x, y) => `M${x - 3.4} ${y}a3.4 3.4 0 1 0 6.8 0a3.4 3.4 0 1 0 -6.8 0Z`;
const shapes = [ring, (x, y) => `M${x - 3.2} ${y - 3.2}h6.4v6.4h-6.4Z`, (x, y) => `M${x - 4} ${y + 3}h8l-4 -7.4Z`,
  (x, y) => `M${x} ${y - 4.4}l4.4 4.4l-4.4 4.4l-4.4 -4.4Z`, (x, y) => `M${x - 4} ${y - 3}h8l-4 7.4Z`, ring,
  (x, y) => `M${x - 3.6} ${y}h7.2M${x} ${y - 3.6}v7.2`, (x, y) => `M${x - 3} ${y - 3}l6 6m0 -6l-6 6`];
const line_class = (style) => "line c" + style % 7 + " d" + style % 4;
const marker_class = (style) => "marker f" + style % 7 + (style % 8 === 5 ? " hollow" : style % 8 > 5 ? " stroke" : "");
const draw_marker = (parent, style, x, y) => draw(parent, "path", {class: marker_class(style), d: shapes[style % 8](x, y)});

// [iteration, log10 of the residual] of a cell, up to an iteration. The curve may have been thinned.
function points(cell, limit) {
  const curve = cell[CURVE], last = curve.length - 1;
  const scale = known(cell[7]) && cell[7] > last && last > 0 ? cell[7] / last : 1;
  return curve.map((v, k) => [k * scale, v === null ? null : Math.max(-18, v / 100)]).filter(([k]) => k <= limit);
}
const defined = (way) => way.filter(([, v]) => v !== null);

// Where words of a width can stand right of a point without touching the others: tried ever further up and down.
function free_place(x, y, width, taken, box) {
  for (let k = 0; k < 80; ++k) {
    const top = y + (k % 2 ? 1 : -1) * Math.ceil(k / 2) * 7;
    if (top < box.top + 4 || top > box.bottom - 2) continue;
    if (taken.some((t) => Math.abs(t.y - top) < 13.5 && x < t.x + t.width && t.x < x + width)) continue;
    taken.push({x, y: top, width});
    return top;
  }
  return y;
}

function draw_frame(svg, box, x, y, span, low, high) {
  const step = Math.max(1, Math.ceil((high - low) / 10));
  for (let k = Math.ceil(low / step) * step; k <= high; k += step) {
    draw(svg, "line", {class: "grid", x1: box.left, x2: box.right, y1: y(k), y2: y(k)});
    draw(svg, "text", {x: box.left - 6, y: y(k) + 4, "text-anchor": "end"}, "1e" + k);
  }
  const power = Math.pow(10, Math.floor(Math.log10(span / 8)));
  const tick = Math.max(1, [1, 2, 5, 10].find((f) => f * power >= span / 8 * 0.999) * power);
  for (let k = 0; k <= span; k += tick) {
    draw(svg, "line", {class: "grid", x1: x(k), x2: x(k), y1: box.top, y2: box.bottom});
    draw(svg, "text", {x: x(k), y: box.bottom + 17, "text-anchor": "middle"}, k);
  }
  draw(svg, "line", {class: "axis", x1: box.left, x2: box.right, y1: box.bottom, y2: box.bottom});
  draw(svg, "text", {x: (box.left + box.right) / 2, y: box.bottom + 36, "text-anchor": "middle"}, "iterations");
  const tol = Math.log10(data.tol);
  if (!(tol > low && tol < high)) return;
  draw(svg, "line", {class: "axis", "stroke-dasharray": "4 4", x1: box.left, x2: box.right, y1: y(tol), y2: y(tol)});
  draw(svg, "text", {x: box.left + 4, y: y(tol) - 4}, "tolerance");
}

function draw_way(svg, cell, way, x, y) {
  const style = data.styles[cell[M]];
  let path = "", open = false;
  for (const [k, v] of way) {
    if (v !== null) path += (open ? "L" : "M") + x(k).toFixed(1) + " " + y(v).toFixed(1);
    open = v !== null;
  }
  draw(svg, "path", {class: line_class(style), d: path});
  const seen = defined(way), every = Math.max(1, Math.floor(seen.length / 10));
  seen.forEach(([k, v], i) => {
    if (i % every !== style % every && i !== seen.length - 1) return;
    draw(draw_marker(svg, style, x(k), y(v)), "title", {}, data.methods[cell[M]] + ": " +
      Math.pow(10, v).toExponential(1) + " after iteration " + Math.round(k));
  });
}

function draw_labels(svg, ways, x, y, box) {
  const ends = ways.map(([cell, way]) => [cell, ...defined(way).pop()]), taken = [];
  for (const [, k, v] of ends) taken.push({x: x(k) - 4, y: y(v), width: 8});
  for (const [cell, k, v] of ends.sort((a, b) => b[2] - a[2])) {
    const outcome = data.outcomes[cell[OUTCOME]];
    const words = data.methods[cell[M]] + (outcome === "solved" ? "" : " (" + outcome + ")");
    const left = x(k) + 9, place = free_place(left, y(v), 7 * words.length, taken, box);
    if (Math.abs(place - y(v)) > 9)
      draw(svg, "path", {class: "leader c" + data.styles[cell[M]] % 7, d: `M${x(k) + 4} ${y(v)}L${left - 1} ${place}`});
    draw(svg, "text", {class: "label", x: left, y: place + 4}, words);
  }
}

function draw_curves() {
  const parent = by_id("curves"), problem = Number(by_id("curve-problem").value);
  const start = Number(by_id("curve-start").value), asked = Number(by_id("curve-length").value) || Infinity;
  parent.textContent = "";
  const menu = by_id("curve-problem");
  by_id("curves-title").textContent = menu.value === "" ? "" : menu.selectedOptions[0].textContent + " from start " + start;
  const cells = data.cells.filter((c) => c[P] === problem && c[START] === start && curve_shown[c[M]]);
  const ways = cells.map((c) => [c, points(c, asked)]).filter(([, way]) => defined(way).length > 0);
  const without = cells.filter((c) => !ways.some(([w]) => w === c))
    .map((c) => data.methods[c[M]] + " (" + data.outcomes[c[OUTCOME]] + ")");
  by_id("curves-note").textContent = without.length === 0 ? "" : "Without a curve: " + without.join(", ") + ".";
  if (ways.length === 0) return add(parent, "p", {class: "note"}, "None of the chosen methods left a curve here.");
  const span = Math.max(1, ...ways.map(([, way]) => way[way.length - 1][0]));
  const box = {left: 56, right: 900, top: 14, bottom: 14 + Math.max(400, 14 * ways.length)};
  const heights = ways.flatMap(([, way]) => defined(way).map((p) => p[1]));
  const high = Math.min(20, Math.ceil(Math.max(...heights))), low = Math.min(high - 1, Math.floor(Math.min(...heights)));
  const x = (k) => box.left + k / span * (box.right - box.left);
  const y = (v) => box.bottom - (Math.min(v, high) - low) / (high - low) * (box.bottom - box.top);
  const svg = draw(parent, "svg", {viewBox: "0 0 1120 " + (box.bottom + 46), role: "img"});
  draw(svg, "title", {}, "Convergence on " + data.problems[problem][0] + " from start " + start);
  draw_frame(svg, box, x, y, span, low, high);
  for (const [cell, way] of ways) draw_way(svg, cell, way, x, y);
  draw_labels(svg, ways, x, y, box);
}

function fill_starts(chosen) {
  const problem = Number(by_id("curve-problem").value), menu = by_id("curve-start");
  menu.textContent = "";
  const starts = new Set(data.cells.filter((c) => c[P] === problem).map((c) => c[START]));
  for (const start of Array.from(starts).sort((a, b) => a - b)) add(menu, "option", {value: start}, start);
  if (starts.has(chosen)) menu.value = chosen;
}

function choose(problem, start, method) {
  if (method !== undefined && !curve_shown[method]) curve_buttons[method].click();
  by_id("curve-problem").value = problem;
  fill_starts(start);
  draw_curves();
}

// The methods as buttons, in the order of their styles, which is that of what they solve; eight to begin with.
const curve_shown = data.styles.map((style) => style < 8), curve_buttons = [];
for (const m of data.styles.map((style, k) => [style, k]).sort((a, b) => a[0] - b[0]).map((pair) => pair[1])) {
  const button = add(add(by_id("curve-methods"), "li", {}), "button", {type: "button", "aria-pressed": curve_shown[m]});
  const sample = draw(button, "svg", {viewBox: "0 0 34 12", "aria-hidden": "true"});
  draw(sample, "path", {class: line_class(data.styles[m]), d: "M1 6H33"});
  draw_marker(sample, data.styles[m], 17, 6);
  add(button, "span", {}, data.methods[m]);
  button.addEventListener("click", () => {
    curve_shown[m] = !curve_shown[m];
    button.setAttribute("aria-pressed", curve_shown[m]);
    draw_curves();
  });
  curve_buttons[m] = button;
}
const in_use = new Set(data.cells.map((c) => c[P]));
data.problems.forEach(([name, cls, n], k) => {
  if (in_use.has(k)) add(by_id("curve-problem"), "option", {value: k}, name + " (" + cls + ", n = " + n + ")");
});
by_id("curve-problem").addEventListener("change", () => choose(Number(by_id("curve-problem").value), 1));
by_id("curve-start").addEventListener("change", draw_curves);
by_id("curve-length").addEventListener("change", draw_curves);
if (data.shown) choose(data.shown[0], data.shown[1]);
else if (data.cells.length > 0) choose(data.cells[0][P], data.cells[0][START]);
else draw_curves();
for (const element of document.querySelectorAll(".needs-script")) element.hidden = false;
