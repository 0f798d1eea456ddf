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
      if (k > 0) return add(row, "td", css ? {class: css} : {}, bad ? "\u26a0 " + text : text);
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
