// SPDX-License-Identifier: Apache-2.0
// Sorting, searching, curves brought out. Text reaches the page by textContent only, never as HTML.
const data = JSON.parse(document.getElementById("data").textContent);
const by_id = (id) => document.getElementById(id);

function add(parent, name, attributes, text) {
  const svg = parent.closest("svg") || name === "svg";
  const element = svg ? document.createElementNS("http://www.w3.org/2000/svg", name) : document.createElement(name);
  for (const key in attributes) element.setAttribute(key, attributes[key]);
  if (text !== undefined) element.textContent = text;
  return parent.appendChild(element);
}

// Order of two texts: numbers by size, what is not known last either way.
function order(a, b, down) {
  const none = (v) => v === "" || v === "-";
  if (none(a) || none(b)) return none(a) - none(b);
  const x = a === "inf" ? Infinity : Number(a), y = b === "inf" ? Infinity : Number(b);
  const sign = isNaN(x) || isNaN(y) ? (a < b ? -1 : a > b) : x < y ? -1 : x > y;
  return down ? -sign : sign;
}

// A header becomes a button; first numbers go down, words up.
function make_sortable(th, number, sort) {
  const button = add(th, "button", {type: "button"}, th.textContent);
  th.firstChild.remove();
  button.addEventListener("click", () => {
    const before = th.getAttribute("aria-sort"), down = before ? before === "ascending" : number;
    for (const other of th.parentNode.cells) other.removeAttribute("aria-sort");
    th.setAttribute("aria-sort", down ? "descending" : "ascending");
    sort(down);
  });
}

for (const table of document.querySelectorAll("table.sortable"))
  Array.from(table.tHead.rows[0].cells).forEach((th, k) => make_sortable(th, th.classList.contains("n"), (down) => {
    const key = (row) => row.cells[k].dataset.key || row.cells[k].textContent;
    table.tBodies[0].append(...Array.from(table.tBodies[0].rows).sort((a, b) => order(key(a), key(b), down)));
  }));

// Names above the charts: pressing shows a curve or makes it grey, resting on one brings it out.
for (const button of document.querySelectorAll(".legend button")) {
  const section = button.closest("section");
  const curves = section.querySelectorAll(`g[id$="-${button.dataset.curve}"]`);
  const each = (name, on) => curves.forEach((g) => g.classList.toggle(name, on));
  const lit = (on) => { section.classList.toggle("lit", on); each("strong", on); };
  button.addEventListener("click", () => {
    const on = button.getAttribute("aria-pressed") !== "true";
    button.setAttribute("aria-pressed", on);
    each("muted", !on);
    if (section.id === "convergence") draw_curves();
  });
  for (const event of ["mouseenter", "focus"]) button.addEventListener(event, () => lit(true));
  for (const event of ["mouseleave", "blur"]) button.addEventListener(event, () => lit(false));
}

// The table of all runs: rows are made for a hundred at a time.
const rows = data.rows.map((row) => row.map((v) => v === null ? "" : String(v)));
const place = Object.fromEntries(data.columns.map((name, k) => [name, k]));
const pair_of = (row) => row[place.problem] + " from start " + row[place.start];
let chosen = rows, sorted = null, shown = 100;

function show_rows() {
  by_id("cells-body").textContent = "";
  for (const row of chosen.slice(0, shown)) {
    const tr = add(by_id("cells-body"), "tr");
    row.forEach((text, k) => {
      const name = data.columns[k], bad = name === "outcome" && text.startsWith("false-");
      if (k > 0 || !by_id("convergence")) return add(tr, k > 0 ? "td" : "th", {class: bad ? "bad" : name, "data-label": name}, text);
      const words = {type: "button", class: "show", title: "show its convergence"};
      const button = add(add(tr, "th", {scope: "row"}), "button", words, text);
      button.addEventListener("click", () => { choose(pair_of(row), text); by_id("convergence").scrollIntoView(); });
    });
  }
  const count = Math.min(shown, chosen.length);
  by_id("cells-count").textContent = `${count} of ${chosen.length} runs that fit, of ${rows.length}`;
  by_id("cells-more").hidden = shown >= chosen.length;
}

function select_rows() {
  const words = by_id("cells-search").value.toLowerCase().split(/\s+/).filter(Boolean);
  chosen = rows.filter((row) => words.every((word) => row.join("\n").toLowerCase().includes(word)));
  if (sorted) chosen.sort((a, b) => order(a[sorted.column], b[sorted.column], sorted.down));
  shown = 100;
  show_rows();
}

// The convergence of the chosen methods on the chosen pair, as wide as the page is.
function draw_curves() {
  const parent = by_id("curves"), pair = by_id("curve-problem").value;
  by_id("curves-title").textContent = pair;
  parent.textContent = "";
  const buttons = document.querySelectorAll("#curve-methods [aria-pressed=true]");
  const pressed = new Set(Array.from(buttons, (b) => b.dataset.name));
  const all = rows.map((row, k) => ({row, name: row[place.method], outcome: row[place.outcome], curve: data.curves[k]}))
    .filter(({row, name}) => pressed.has(name) && pair_of(row) === pair);
  const drawn = all.filter(({curve}) => curve.some((v) => v !== null));
  const listed = (of) => of.map(({name, outcome}) => `${name} (${outcome})`).join(", ");
  const unsolved = drawn.filter(({outcome}) => outcome !== "solved"), without = all.filter((c) => !drawn.includes(c));
  by_id("curves-note").textContent = (unsolved.length ? `Not solved by: ${listed(unsolved)}. ` : "") +
    (without.length ? `Without a curve: ${listed(without)}.` : "");
  if (!drawn.length) return add(parent, "p", {}, "None of the chosen methods left a curve here.");
  // A long curve has been thinned: its points are that many iterations apart.
  const scale = ({row, curve}) => Math.max(1, row[place.iterations] / Math.max(1, curve.length - 1));
  const points = drawn.map((c) => c.curve.map((v, k) => [k * scale(c), Math.max(-18, v / 100), v])
    .filter(([, , v]) => v !== null));
  const heights = points.flat().map((p) => p[1]), span = Math.max(1, ...points.flat().map((p) => p[0]));
  const high = Math.min(20, Math.ceil(Math.max(...heights)));
  const low = Math.min(high - 1, Math.floor(Math.min(...heights)));
  const width = Math.max(300, parent.clientWidth), height = width < 600 ? 300 : 420;
  const x = (k) => 45 + k / span * (width - 65);
  const y = (v) => height - 15 - (Math.min(v, high) - low) / (high - low) * (height - 30);
  const svg = add(parent, "svg", {viewBox: `0 0 ${width} ${height + 30}`, role: "img"});
  for (let v = low, step = Math.ceil((high - low) / 10); v <= high; v += step) {
    add(svg, "line", {x1: 45, x2: width - 20, y1: y(v), y2: y(v), stroke: "#e2e2e2"});
    add(svg, "text", {x: 22, y: y(v) + 4}, "1e" + v);
  }
  const apart = Math.ceil(span / (width / 90));
  for (let k = 0; k <= span; k += apart) add(svg, "text", {x: x(k), y: height + 5}, k);
  add(svg, "text", {x: width / 2, y: height + 24}, "iterations");
  const tol = Math.log10(data.tol);
  if (tol > low && tol < high)
    add(svg, "line", {x1: 45, x2: width - 20, y1: y(tol), y2: y(tol), stroke: "#333", "stroke-dasharray": "4 4"});
  drawn.forEach(({name}, i) => {
    const {colour, dash, marker} = data.styles[name], every = Math.max(1, Math.floor(points[i].length / 10));
    const line = points[i].map(([k, v]) => `${x(k).toFixed(1)},${y(v).toFixed(1)}`).join(" ");
    add(svg, "polyline", {points: line, stroke: colour, "stroke-dasharray": dash});
    points[i].forEach(([k, v], at) => {
      if (at % every !== i % every && at !== points[i].length - 1) return;
      const mark = add(svg, "text", {x: x(k), y: y(v) + 4, fill: colour}, marker);
      add(mark, "title", {}, `${name}: 1e${v.toFixed(1)} after iteration ${Math.round(k)}`);
    });
  });
}

function choose(pair, method) {
  by_id("curve-problem").value = pair;
  const button = Array.from(document.querySelectorAll("#curve-methods button")).find((b) => b.dataset.name === method);
  if (button && button.getAttribute("aria-pressed") !== "true") button.click();
  draw_curves();
}

data.columns.forEach((name, column) => {
  const th = add(by_id("cells-head"), "th", {scope: "col"}, name);
  const number = rows.some((row) => row[column] !== "" && !isNaN(Number(row[column])));
  make_sortable(th, number, (down) => { sorted = {column, down}; select_rows(); });
});
by_id("cells-search").addEventListener("input", select_rows);
by_id("cells-more").addEventListener("click", () => { shown += 1000; show_rows(); });
select_rows();
if (by_id("convergence")) {
  for (const pair of new Set(rows.map(pair_of).sort())) add(by_id("curve-problem"), "option", {value: pair}, pair);
  by_id("curve-problem").addEventListener("change", draw_curves);
  window.addEventListener("resize", draw_curves);
  choose(data.shown[0] || by_id("curve-problem").value);
}
