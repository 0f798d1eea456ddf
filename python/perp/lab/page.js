// SPDX-License-Identifier: Apache-2.0
// Sorting, searching, curves brought out. Text reaches the page by textContent only, never as HTML.
const data = JSON.parse(document.getElementById("data").textContent);
const by_id = (id) => document.getElementById(id);
const known = (v) => v !== null && v !== undefined;

function add(parent, name, attributes, text) {
  const element = document.createElement(name);
  for (const key in attributes) element.setAttribute(key, attributes[key]);
  if (known(text)) element.textContent = text;
  parent.appendChild(element);
  return element;
}

// Order of two values: numbers by size, what is not known last either way.
function order(a, b, down) {
  const none_a = !known(a) || a === "" || Number.isNaN(a), none_b = !known(b) || b === "" || Number.isNaN(b);
  if (none_a || none_b) return none_a - none_b;
  const sign = typeof a === "number" && typeof b === "number" ? a - b :
      String(a) < String(b) ? -1 : String(a) > String(b) ? 1 : 0;
  return down ? -sign : sign;
}

function mark_sorted(row, chosen, down) {
  for (const th of row.cells) th.removeAttribute("aria-sort");
  chosen.setAttribute("aria-sort", down ? "descending" : "ascending");
}

// A header becomes a button; first numbers go down, words up.
function sortable_header(th, number, sort) {
  const words = th.textContent;
  th.textContent = "";
  const button = add(th, "button", {type: "button"}, words);
  button.addEventListener("click", () => {
    const before = th.getAttribute("aria-sort");
    const down = before ? before === "ascending" : number;
    mark_sorted(th.parentNode, th, down);
    sort(down);
  });
}

function sort_rows(body, column, down) {
  const value = (row) => {
    const cell = row.cells[column];
    const text = cell.dataset.key === undefined ? cell.textContent : cell.dataset.key;
    if (text === "" || text === "-") return null;
    return Number.isNaN(Number(text)) ? text : Number(text);
  };
  const rows = Array.from(body.rows, (row) => [value(row), row]);
  rows.sort((a, b) => order(a[0], b[0], down));
  for (const [, row] of rows) body.appendChild(row);
}

for (const table of document.querySelectorAll("table.sortable"))
  Array.from(table.tHead.rows[0].cells).forEach((th, k) =>
    sortable_header(th, th.classList.contains("n"), (down) => sort_rows(table.tBodies[0], k, down)));

// Names under the charts: pressing shows a curve or makes it grey, resting on one brings it out.
for (const button of document.querySelectorAll(".legend button[data-curve]")) {
  const section = button.closest("section");
  const curves = () => section.querySelectorAll('g[id$="-' + button.dataset.curve + '"]');
  const lit = (on) => {
    section.classList.toggle("lit", on);
    for (const g of curves()) g.classList.toggle("strong", on);
  };
  button.addEventListener("click", () => {
    const on = button.getAttribute("aria-pressed") !== "true";
    button.setAttribute("aria-pressed", on);
    for (const g of curves()) g.classList.toggle("muted", !on);
  });
  for (const event of ["mouseenter", "focus"]) button.addEventListener(event, () => lit(true));
  for (const event of ["mouseleave", "blur"]) button.addEventListener(event, () => lit(false));
}

// The table of all cells: rows are made for one page at a time.
if (data) {
const M = 0, P = 1, START = 2, OUTCOME = 3, AFTER = 4, STATUS = 5, NATURAL = 6, RESTARTS = 12, SECONDS = 13, MB = 14,
  MESSAGE = 15, CURVE = 16;
const digits = (v, n) => !known(v) ? "" : typeof v === "string" ? v : String(Number(v.toPrecision(n)));
const exponential = (v) => !known(v) ? "" : typeof v === "string" ? v : v === 0 ? "0" : v.toExponential(1);
const plain = (k) => [(c) => c[k], (v) => known(v) ? String(v) : ""];
const columns = [
  ["method", false, (c) => data.methods[c[M]], String], ["problem", false, (c) => data.problems[c[P]][0], String],
  ["class", false, (c) => data.problems[c[P]][1], String], ["n", true, (c) => data.problems[c[P]][2], String],
  ["start", true, ...plain(START)], ["outcome", false, (c) => data.outcomes[c[OUTCOME]], String],
  ["after restarts", false, (c) => c[RESTARTS] > 0 ? data.outcomes[c[AFTER]] + " (" + c[RESTARTS] + ")" : "", String],
  ["status", false, ...plain(STATUS)], ["residual", true, (c) => c[NATURAL] === "inf" ? Infinity : c[NATURAL],
    (v) => v === Infinity ? "inf" : exponential(v)],
  ["iter.", true, ...plain(7)], ["F", true, ...plain(8)], ["J", true, ...plain(9)], ["fact.", true, ...plain(10)],
  ["Krylov", true, ...plain(11)], ["seconds", true, (c) => c[SECONDS], (v) => digits(v, 3)],
  ["MiB", true, (c) => c[MB], (v) => known(v) ? v.toFixed(0) : ""], ["message", false, ...plain(MESSAGE)]]
  .filter(([, , value, words], k) => k < 6 || data.cells.some((c) => !["", "0"].includes(words(value(c)))));
const false_claims = new Set(["false-convergence", "false-infeasible"]);
let rows = data.cells, first = 0, page = 100, sorted = null;
const texts = data.cells.map((c) => columns.filter((k) => !k[1]).map((k) => k[2](c)).concat("start " + c[START])
  .join("\n").toLowerCase());
const place = new Map(data.cells.map((c, k) => [c, k]));

function show_page() {
  const body = by_id("cells-body");
  body.textContent = "";
  const last = Math.min(first + page, rows.length);
  for (const cell of rows.slice(first, last)) {
    const row = add(body, "tr", {});
    columns.forEach(([name, number, value, words], k) => {
      const text = words(value(cell));
      const bad = name === "outcome" && false_claims.has(text);
      const css = (number ? "n" : name === "message" ? "message" : "w") + (bad ? " bad" : "");
      if (k > 0) return add(row, "td", {class: css, "data-label": name}, text === "" ? null : bad ? "\u26a0 " + text : text);
      const show = add(add(row, "th", {scope: "row"}), "button",
        {type: "button", class: "show", title: "show its convergence"}, text);
      show.addEventListener("click", () => { choose(cell[P], cell[START], cell[M]); by_id("convergence").scrollIntoView(); });
    });
  }
  by_id("cells-count").textContent = rows.length === 0 ? "No cell fits." : (first + 1) + " to " + last + " of " +
    rows.length + (rows.length < data.cells.length ? " that fit, of " + data.cells.length : "") + " cells";
  by_id("cells-back").disabled = first === 0;
  by_id("cells-on").disabled = last >= rows.length;
}

function select_cells() {
  const words = by_id("cells-search").value.toLowerCase().split(/\s+/).filter(Boolean);
  const outcome = by_id("cells-outcome").value, cls = by_id("cells-class").value;
  rows = data.cells.filter((c) => (outcome === "" || c[OUTCOME] === Number(outcome)) &&
    (cls === "" || data.problems[c[P]][1] === cls) && words.every((w) => texts[place.get(c)].includes(w)));
  if (sorted) {
    const [value, down] = sorted;
    rows = rows.map((c) => [value(c), c]).sort((a, b) => order(a[0], b[0], down)).map((pair) => pair[1]);
  }
  first = 0;
  show_page();
}

columns.forEach(([name, number, value]) => {
  const th = add(by_id("cells-head"), "th", number ? {scope: "col", class: "n"} : {scope: "col"}, name);
  sortable_header(th, number, (down) => { sorted = [value, down]; select_cells(); });
});
by_id("cells-search").addEventListener("input", select_cells);
by_id("cells-outcome").addEventListener("change", select_cells);
by_id("cells-class").addEventListener("change", select_cells);
by_id("cells-rows").addEventListener("change", () => {
  page = Number(by_id("cells-rows").value) || Infinity;
  first = 0;
  show_page();
});
by_id("cells-back").addEventListener("click", () => { first = Math.max(0, first - page); show_page(); });
by_id("cells-on").addEventListener("click", () => { first += page; show_page(); });
data.outcomes.forEach((name, k) => {
  const count = data.cells.filter((c) => c[OUTCOME] === k).length;
  if (count > 0) add(by_id("cells-outcome"), "option", {value: k}, name + " (" + count + ")");
});
for (const cls of Array.from(new Set(data.problems.map((p) => p[1]))).sort())
  add(by_id("cells-class"), "option", {value: cls}, cls);
select_cells();

// The convergence of the chosen methods on the chosen problem, as wide as the page is.
function draw(parent, name, attributes, text) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const key in attributes) element.setAttribute(key, attributes[key]);
  if (known(text)) element.textContent = text;
  parent.appendChild(element);
  return element;
}

// [iteration, log10 of the residual] of a cell, up to an iteration. The curve may have been thinned.
function points(cell, limit) {
  const curve = cell[CURVE], last = curve.length - 1;
  const scale = known(cell[7]) && cell[7] > last && last > 0 ? cell[7] / last : 1;
  return curve.map((v, k) => [k * scale, v === null ? null : Math.max(-18, v / 100)]).filter(([k]) => k <= limit);
}
const defined = (way) => way.filter(([, v]) => v !== null);

function draw_frame(svg, box, x, y, span, low, high) {
  const step = Math.max(1, Math.ceil((high - low) / 10));
  for (let k = Math.ceil(low / step) * step; k <= high; k += step) {
    draw(svg, "line", {class: "grid", x1: box.left, x2: box.right, y1: y(k), y2: y(k)});
    draw(svg, "text", {x: box.left - 6, y: y(k) + 4, "text-anchor": "end"}, "1e" + k);
  }
  const places = (box.right - box.left) / 90, power = Math.pow(10, Math.floor(Math.log10(span / places)));
  const tick = Math.max(1, [1, 2, 5, 10].find((f) => f * power >= span / places * 0.999) * power);
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
  const style = data.styles[cell[M]], shape = style % 8;
  let path = "", open = false;
  for (const [k, v] of way) {
    if (v !== null) path += (open ? "L" : "M") + x(k).toFixed(1) + " " + y(v).toFixed(1);
    open = v !== null;
  }
  draw(svg, "path", {class: "line c" + style % 7 + " d" + style % 4, d: path});
  const seen = defined(way), every = Math.max(1, Math.floor(seen.length / 10));
  seen.forEach(([k, v], i) => {
    if (i % every !== style % every && i !== seen.length - 1) return;
    const css = "marker f" + style % 7 + (shape === 5 ? " hollow" : shape > 5 ? " stroke" : "");
    const marker = draw(svg, "path", {class: css, d: data.shapes[shape], transform: `translate(${x(k) - 17} ${y(v) - 6})`});
    draw(marker, "title", {}, data.methods[cell[M]] + ": " + Math.pow(10, v).toExponential(1) + " after iteration " + Math.round(k));
  });
}

function draw_curves() {
  const parent = by_id("curves"), problem = Number(by_id("curve-problem").value);
  const start = Number(by_id("curve-start").value), asked = Number(by_id("curve-length").value) || Infinity;
  parent.textContent = "";
  const menu = by_id("curve-problem");
  by_id("curves-title").textContent = menu.value === "" ? "" : menu.selectedOptions[0].textContent + " from start " + start;
  const cells = data.cells.filter((c) => c[P] === problem && c[START] === start && curve_shown[c[M]]);
  const ways = cells.map((c) => [c, points(c, asked)]).filter(([, way]) => defined(way).length > 0);
  const words = (chosen) => chosen.map((c) => data.methods[c[M]] + " (" + data.outcomes[c[OUTCOME]] + ")").join(", ");
  const without = cells.filter((c) => !ways.some(([w]) => w === c));
  const unsolved = ways.map(([c]) => c).filter((c) => data.outcomes[c[OUTCOME]] !== "solved");
  by_id("curves-note").textContent = (unsolved.length > 0 ? "Not solved by: " + words(unsolved) + ". " : "") +
    (without.length > 0 ? "Without a curve: " + words(without) + "." : "");
  if (ways.length === 0) return add(parent, "p", {class: "note"}, "None of the chosen methods left a curve here.");
  const span = Math.max(1, ...ways.map(([, way]) => way[way.length - 1][0])), width = Math.max(320, parent.clientWidth);
  const box = {left: 50, right: width - 14, top: 14, bottom: width < 600 ? 300 : 414};
  const heights = ways.flatMap(([, way]) => defined(way).map((p) => p[1]));
  const high = Math.min(20, Math.ceil(Math.max(...heights))), low = Math.min(high - 1, Math.floor(Math.min(...heights)));
  const x = (k) => box.left + k / span * (box.right - box.left);
  const y = (v) => box.bottom - (Math.min(v, high) - low) / (high - low) * (box.bottom - box.top);
  const svg = draw(parent, "svg", {viewBox: `0 0 ${width} ${box.bottom + 46}`, role: "img"});
  draw(svg, "title", {}, "Convergence on " + data.problems[problem][0] + " from start " + start);
  draw_frame(svg, box, x, y, span, low, high);
  for (const [cell, way] of ways) draw_way(svg, cell, way, x, y);
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

const curve_shown = data.styles.map((style) => style < 8), curve_buttons = [];
for (const button of document.querySelectorAll("#curve-methods button")) {
  const m = Number(button.dataset.method);
  curve_buttons[m] = button;
  button.addEventListener("click", () => {
    curve_shown[m] = !curve_shown[m];
    button.setAttribute("aria-pressed", curve_shown[m]);
    draw_curves();
  });
}
const in_use = new Set(data.cells.map((c) => c[P]));
data.problems.forEach(([name, cls, n], k) => {
  if (in_use.has(k)) add(by_id("curve-problem"), "option", {value: k}, name + " (" + cls + ", n = " + n + ")");
});
by_id("curve-problem").addEventListener("change", () => choose(Number(by_id("curve-problem").value), 1));
by_id("curve-start").addEventListener("change", draw_curves);
by_id("curve-length").addEventListener("change", draw_curves);
window.addEventListener("resize", draw_curves);
if (data.shown) choose(data.shown[0], data.shown[1]);
else if (data.cells.length > 0) choose(data.cells[0][P], data.cells[0][START]);
else draw_curves();
for (const element of document.querySelectorAll(".needs-script")) element.hidden = false;
}
