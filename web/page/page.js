// SPDX-License-Identifier: Apache-2.0
// The page: a client of the program `perp`, of its words and of the JSON that docs/schema describes. engine.js comes
// before it, with perp_engine: the worker's source, the program as compressed WebAssembly, and the examples.
"use strict";

const $ = (id) => document.getElementById(id);
const rows_shown = 200;

function bytes_of(base64) {
  return Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
}

/** The program, compiled once. */
const engine = (async () => {
  const packed = new Blob([bytes_of(perp_engine.program)]).stream();
  const bytes = await new Response(packed.pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  return WebAssembly.compile(bytes);
})();
const worker_source = URL.createObjectURL(new Blob([perp_engine.worker], { type: "text/javascript" }));

class Stopped extends Error {}
let stop_run = () => {}; // ends what runs, if anything does

/** Runs `perp` with these words on these files, in a worker of its own, which the button stops if it is `stoppable`.
 *  Returns code, out, err, files. */
async function perp(args, files, { on_text = () => {}, stoppable = true } = {}) {
  const module = await engine;
  return new Promise((resolve, reject) => {
    const worker = new Worker(worker_source);
    const said = ["", ""];
    const stop = () => end(reject, new Stopped());
    const end = (settle, value) => {
      worker.terminate();
      if (stop_run === stop) stop_run = () => {};
      settle(value);
    };
    if (stoppable) stop_run = stop;
    worker.onerror = (event) => end(reject, new Error(event.message));
    worker.onmessage = ({ data }) => {
      if (data.lines) {
        for (const [stream, text] of data.lines) said[stream - 1] += text;
        on_text(data.lines.map(([, text]) => text).join(""));
      } else if (data.broke) end(reject, new Error(data.broke));
      else end(resolve, { code: data.code, out: said[0], err: said[1], files: data.files });
    };
    worker.postMessage({ module, args, files });
  });
}

const said_by = (run) => run.err.trim().replace(/^perp: /gm, "") || `perp ended with code ${run.code}`;
const json_of = (run, name) => {
  const bytes = run.files[name];
  return bytes === undefined ? undefined : JSON.parse(new TextDecoder().decode(bytes));
};

/** Reason of a failure, in the program's words, or where there are none in the browser's. */
function reason(error) {
  if (/stack/.test(error.message)) return "The expressions of this model are nested deeper than this browser's stack. The program outside of the browser takes up to 10000 levels.";
  if (/memory/i.test(error.message)) return "The memory of this page does not suffice for this problem.";
  return `The engine broke off: ${error.message}. The program outside of the browser may say more.`;
}

const seconds = (since) => `${((performance.now() - since) / 1000).toFixed(1)} s`;
const say = (text) => ($("status").textContent = text);
const show = (id, visible) => ($(id).hidden = !visible);

function refuse(text) {
  $("refused").textContent = text;
  show("refused", text !== "");
}

/** A problem: its title, the words that name it to the program, its files; contact: for the command `contact`. */
let problem;
let result; // of the last solve: {json, columns, rows}
let turn = 0; // of the problem on the page: what comes from an earlier one is dropped

function forget() {
  stop_run();
  problem = result = undefined;
  ++turn;
  refuse("");
  say("");
  for (const id of ["chosen", "roles", "structure-part", "result-part", "log-part"]) show(id, false);
  set_busy(false);
  for (const button of $("examples").children) button.setAttribute("aria-pressed", "false");
}

// Problems.

/** The files under names that the program takes: endings in small letters, nothing that looks like an option, and the
 *  names of rows and columns beside the one model there is, whatever they are called. */
function tidy(files) {
  const tidied = Object.fromEntries(Object.entries(files).map(([name, bytes]) =>
    [name.replace(/\.[^.]*$/, (ending) => ending.toLowerCase()).replace(/^-/, "_"), bytes]));
  const of = (ending) => Object.keys(tidied).filter((name) => name.endsWith(ending));
  const [model, ...others] = of(".nl");
  if (model && others.length === 0)
    for (const ending of [".row", ".col"]) {
      const found = of(ending);
      if (found.length === 1) tidied[model.replace(/\.nl$/, ending)] = tidied[found[0]];
    }
  return tidied;
}

/** The files that were dropped, as one problem. Throws a text where they are none. */
function problem_of(files) {
  const names = Object.keys(files);
  const of = (ending) => names.filter((name) => name.endsWith(ending));
  const one = (list, what) => {
    if (list.length > 1) throw `These are several ${what}: ${list.join(", ")}. Choose one.`;
    return list[0];
  };
  const nl = one(of(".nl"), "models");
  if (nl) return { title: nl, words: [nl], files };
  const hdf5 = one([...of(".hdf5"), ...of(".h5")], "files of FCLIB");
  if (hdf5) return { title: hdf5, words: [hdf5], files, contact: true };
  const dat = one(of(".dat"), "files of Siconos");
  if (dat) return { title: dat, words: [dat], files, either: true };
  if (of(".mtx").length > 0) return matrix_problem(files, of(".mtx"));
  if (names.length === 0) throw "There is no file.";
  throw `${names.join(", ")}: not a file that Perp reads. It reads .nl, .mtx, .dat and .hdf5.`;
}

/** M and q, and bounds, from the names of Matrix Market files and from what they hold; the user can change it. */
function matrix_problem(files, names) {
  const first = (name) => new TextDecoder().decode(files[name].subarray(0, 4096)).split("\n");
  const size = (name) => first(name).find((line) => line.trim() && !line.startsWith("%"))?.trim().split(/\s+/) ?? [];
  const named = (pattern) => names.find((name) => pattern.test(name));
  const matrix = names.find((name) => Number(size(name)[1]) > 1) ?? named(/^m\b/i) ?? names[0];
  const others = names.filter((name) => name !== matrix);
  const lower = others.find((name) => /(^|[_.-])l(ower)?\b/i.test(name)), upper = others.find((name) => /(^|[_.-])u(pper)?\b/i.test(name));
  const vector = others.find((name) => /(^|[_.-])q\b/i.test(name)) ?? others.find((name) => name !== lower && name !== upper);
  return { title: matrix, files, names, roles: { M: matrix, q: vector ?? "", lower: lower ?? "", upper: upper ?? "" } };
}

const role_labels = { M: "Matrix M", q: "Vector q", lower: "Lower bounds", upper: "Upper bounds" };
const role_defaults = { M: "none", q: "none", lower: "0", upper: "infinity" };

function show_roles() {
  const shown = problem;
  $("roles").replaceChildren(...Object.keys(role_labels).map((role) => {
    const label = document.createElement("label");
    const select = document.createElement("select");
    select.append(new Option(role_defaults[role], ""), ...shown.names.map((name) => new Option(name, name)));
    select.value = shown.roles[role];
    select.addEventListener("change", () => {
      const changed = { ...shown, roles: { ...shown.roles, [role]: select.value } };
      forget();
      take(changed);
    });
    label.append(`${role_labels[role]} `, select);
    return label;
  }));
  show("roles", true);
}

function words_of_roles({ M, q, lower, upper }) {
  if (!M || !q) throw "A problem of Matrix Market files needs M and q: drop both files.";
  return [M, q, ...(lower ? ["--lower", lower] : []), ...(upper ? ["--upper", upper] : [])];
}

/** Takes a problem: shows what the program knows of it, or why it refuses it. */
async function take(wanted) {
  const mine = turn;
  problem = wanted;
  $("name").textContent = problem.title;
  show("chosen", true);
  try {
    if (problem.roles) {
      show_roles();
      problem.words = words_of_roles(problem.roles);
    }
    say(`Reading ${problem.title} ...`);
    set_busy(true, "read");
    const run = await look(problem);
    if (mine !== turn) return;
    if (run.code === 2) throw said_by(run);
    show_methods();
    $("structure").textContent = run.out.trimEnd();
    show("structure-part", true);
    say("Ready to solve.");
  } catch (error) {
    if (mine !== turn) return;
    say("");
    refuse(typeof error === "string" ? error : error instanceof Stopped ? "Stopped before it was read." : reason(error));
    problem = undefined;
  } finally {
    if (mine === turn) set_busy(false);
  }
}

/** Facts known before solving: the command inspect, and of contact the sizes, by the cheapest law. */
async function look(of) {
  if (!of.contact) {
    const run = await perp(["inspect", ...of.words], of.files);
    if (!of.either || run.code !== 2) return run;
    const contact = await look({ ...of, either: false, contact: true });
    if (contact.code === 2) return { ...run, err: `As an LCP: ${said_by(run)}\nAs contact: ${said_by(contact)}` };
    of.contact = true;
    return contact;
  }
  const run = await perp(["contact", ...of.words, "--formulation", "frictionless", "--time-limit", "5"], of.files);
  return { ...run, out: run.out.split("\n\n")[0].split("\n").filter((line) => !line.startsWith("frictionless")).join("\n") };
}

async function take_files(list) {
  if (list.length === 0) return;
  forget();
  const mine = turn;
  try {
    const read = await Promise.all([...list].map(async (file) => [file.name, new Uint8Array(await file.arrayBuffer())]));
    if (mine === turn) await take(problem_of(tidy(Object.fromEntries(read))));
  } catch (error) {
    refuse(typeof error === "string" ? error : `The file cannot be read: ${error.message}`);
  }
}

function show_examples() {
  for (const example of perp_engine.examples) {
    const button = document.createElement("button");
    const title = document.createElement("strong"), text = document.createElement("span");
    title.textContent = example.title;
    text.textContent = example.text;
    button.type = "button";
    button.append(title, text);
    button.setAttribute("aria-pressed", "false");
    button.addEventListener("click", () => {
      forget();
      button.setAttribute("aria-pressed", "true");
      const files = Object.fromEntries(Object.entries(example.files).map(([name, content]) => [name, bytes_of(content)]));
      take({ title: example.words[0], words: example.words, files, contact: example.contact });
    });
    $("examples").append(button);
  }
}

// Solving.

let methods = []; // of the command `methods`

function show_methods() {
  const select = $("method");
  show("prove-part", !problem?.contact);
  const names = problem?.contact ? ["auto", "homotopy", "nsgs", "alart-curnier"] : methods;
  const before = select.value;
  select.replaceChildren(...names.map((name) => new Option(name, name)));
  select.value = names.includes(before) ? before : "auto";
}

function set_busy(busy, what) {
  $("solve").disabled = busy || problem === undefined;
  $("stop").disabled = !busy;
  $("result-part").setAttribute("aria-busy", String(busy && what === "solve"));
}

async function solve() {
  const mine = turn;
  const started = performance.now();
  const now = problem;
  const common = ["--tol", $("tolerance").value.trim(), "--time-limit", $("limit").value.trim()];
  const words = [now.contact ? "contact" : "solve", ...now.words, ...common, "--json", "result.json"];
  if ($("method").value !== "auto") words.push("--method", $("method").value);
  if (!now.contact) words.push("--plot", "way.svg", ...($("prove").checked ? ["--verify"] : []));
  refuse("");
  show("result-part", false);
  show("log-part", true);
  $("log-part").open = true;
  $("log").textContent = "";
  set_busy(true, "solve");
  const clock = setInterval(() => ($("solve").textContent = `Solving, ${seconds(started)}`), 200);
  say("Solving ...");
  try {
    const run = await perp(words, now.files, { on_text: log });
    if (mine !== turn) return;
    const json = json_of(run, "result.json");
    if (run.code > 1 || json === undefined) throw said_by(run);
    show_result(json);
    show_way(run.files["way.svg"]);
    $("log-part").open = false; // the result comes into view
    if (run.code === 1 && !now.contact) await explain(now, mine, started);
    if (mine === turn) say(`${json.status} after ${seconds(started)}.`);
  } catch (error) {
    if (mine !== turn) return;
    if (error instanceof Stopped) say(`Stopped after ${seconds(started)}. What this run had found is lost.`);
    else {
      say("");
      refuse(typeof error === "string" ? error : reason(error));
    }
  } finally {
    clearInterval(clock);
    $("solve").textContent = "Solve";
    if (mine === turn) set_busy(false);
  }
}

async function explain(of, mine, started) {
  say(`${result.json.status}; looking for the reason ...`);
  try {
    const run = await perp(["explain", ...of.words, "--time-limit", $("limit").value.trim()], of.files);
    if (mine !== turn) return;
    $("explanation").textContent = run.out.trim() || run.err.trim();
    show("explanation-part", true);
  } catch (error) {
    if (!(error instanceof Stopped)) throw error;
    if (mine === turn) say(`Stopped after ${seconds(started)}, before a reason was found.`);
  }
}

const log_shown = 200000; // characters: a browser becomes slow with more

function log(text) {
  const place = $("log");
  const follows = place.scrollTop + place.clientHeight > place.scrollHeight - 8;
  const all = place.textContent + text;
  place.textContent = all.length > log_shown ? `...${all.slice(-log_shown)}` : all;
  if (follows) place.scrollTop = place.scrollHeight;
}

// The result.

/** Numbers in the JSON of the program: "inf", "-inf" and "nan" are texts there. */
const number = (value) => (typeof value === "number" ? value : value === "inf" ? Infinity : value === "-inf" ? -Infinity : NaN);
const text_of = (value) => {
  if (typeof value !== "number") return value === null || value === undefined ? "" : String(value);
  return Math.abs(value) < 1e16 && Number.isInteger(value) ? String(value) : String(Number(value.toPrecision(7)));
};
const norm = (values) => Math.hypot(...values.map(number));

const mcp_columns = [
  ["variable", (v) => v.name], ["lower", (v) => v.lower], ["value", (v) => v.value], ["upper", (v) => v.upper],
  ["equation", (v) => v.equation], ["F", (v) => v.F], ["state", (v) => v.state],
];
const contact_columns = [
  ["contact", (c) => String(c.contact)], ["state", (c) => c.state], ["mu", (c) => c.mu],
  ["r_N [N s]", (c) => c.r[0]], ["|r_T| [N s]", (c) => norm(c.r.slice(1))],
  ["u_N [m/s]", (c) => c.u[0]], ["|u_T| [m/s]", (c) => norm(c.u.slice(1))],
];

function show_result(json) {
  const of_contact = json.contacts !== undefined;
  const columns = of_contact ? contact_columns : mcp_columns;
  const list = (of_contact ? json.contacts : json.variables) ?? [];
  result = { json, columns, rows: list.map((entry) => columns.map(([, value]) => value(entry))) };

  const status = document.createElement("strong");
  status.textContent = json.status;
  status.className = json.exit_code === 0 ? "good" : "bad";
  $("outcome").replaceChildren(status, `: ${json.message}${json.advice ? `. Try: ${json.advice}` : ""}`);
  const facts = {
    "natural residual": json.residual?.natural, [of_contact ? "worst contact" : "worst row"]: json.residual?.worst, method: json.method,
    iterations: json.stats?.iterations, "evaluations of F": json.stats?.F_evals, pivots: json.stats?.pivots,
    sweeps: json.stats?.sweeps, open: json.states?.open, stick: json.states?.stick, slip: json.states?.slip,
    "time [s]": json.stats?.time_s, proof: proof_of(json.verified), notes: json.notes?.length ? json.notes.join("; ") : undefined,
  };
  $("facts").replaceChildren(...Object.entries(facts).filter(([, value]) => value !== undefined && value !== null).map(([name, value]) => {
    const pair = document.createElement("div"), term = document.createElement("dt"), text = document.createElement("dd");
    term.textContent = name;
    text.textContent = typeof value === "number" ? String(Number(value.toPrecision(4))) : text_of(value);
    pair.append(term, text);
    return pair;
  }));
  show("explanation-part", false);
  draw_plot(json);
  $("table-title").textContent = json.exit_code === 0 ? "Solution" : "The best point that was met (no solution)";
  $("filter").value = "";
  show("filter-part", list.length > 10);
  show_table();
  show("result-part", true);
}

/** Answer of --verify: y is the one solution in the box. */
function proof_of(verified) {
  if (!verified) return undefined;
  return verified.unique ? `exactly one solution within ${verified.radius.toExponential(1)} of these values` : `none: ${verified.why_not}`;
}

/** The program's own picture, with the path of one iteration. */
function show_way(svg) {
  URL.revokeObjectURL($("way").src);
  show("way-part", svg !== undefined);
  if (svg === undefined) return;
  $("way").src = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
  $("way").alt = `The merit over the iterations, and along the path of one of them: ${result.json.status}.`;
}

function show_table() {
  const word = $("filter").value.trim().toLowerCase();
  const { columns, rows } = result;
  const found = word ? rows.filter((row) => row.some((cell) => typeof cell === "string" && cell.toLowerCase().includes(word))) : rows;
  const is_word = columns.map(([name]) => ["variable", "equation", "state"].includes(name));
  const row_of = (cells, kind) => {
    const row = document.createElement("tr");
    cells.forEach((value, k) => {
      const cell = document.createElement(kind === "th" || k === 0 ? "th" : "td");
      cell.scope = kind === "th" ? "col" : "row";
      cell.textContent = text_of(value);
      if (is_word[k]) cell.className = "word";
      row.append(cell);
    });
    return row;
  };
  const head = document.createElement("thead"), body = document.createElement("tbody");
  head.append(row_of(columns.map(([name]) => name), "th"));
  body.append(...found.slice(0, rows_shown).map((row) => row_of(row, "td")));
  $("table").replaceChildren(head, body);
  $("more").textContent = found.length > rows_shown ? `The first ${rows_shown} of ${found.length} rows. The CSV file has all.`
    : word ? `${found.length} of ${rows.length} rows.` : "";
}

/** The natural residual, from 1e-17, over the iterations, those of the crash first. */
function draw_plot(json) {
  const values = (json.iterations ?? []).map((it) => number(it.residual)).filter(Number.isFinite);
  show("plot-part", values.length > 1);
  if (values.length < 2) return;
  const tolerance = number(json.options?.convergence_tolerance);
  const logs = values.map((value) => Math.log10(Math.max(value, 1e-17)));
  const all = [...logs, ...(tolerance > 0 ? [Math.log10(tolerance)] : [])];
  const low = Math.floor(Math.min(...all)), high = Math.ceil(Math.max(...all) + 0.05);
  const width = Math.max(320, Math.min(900, $("plot-part").clientWidth || document.querySelector("main").clientWidth)), height = 260;
  const left = 48, right = 12, top = 12, bottom = 34;
  const x = (k) => left + (k / (values.length - 1)) * (width - left - right);
  const y = (log) => top + ((high - log) / Math.max(1, high - low)) * (height - top - bottom);
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  const add = (tag, attributes, text) => {
    const element = document.createElementNS(svg.namespaceURI, tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    if (text !== undefined) element.textContent = text;
    svg.append(element);
  };
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.style.maxWidth = `${width}px`;
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", `From ${values[0].toExponential(1)} to ${values.at(-1).toExponential(1)} in ${values.length - 1} steps.`);
  const decades = Math.max(1, Math.ceil((high - low) / 6));
  for (let log = high; log >= low; log -= decades) {
    add("line", { class: "grid", x1: left, x2: width - right, y1: y(log), y2: y(log) });
    add("text", { x: left - 6, y: y(log) + 4, "text-anchor": "end" }, `1e${log}`);
  }
  const every = Math.max(1, Math.ceil((values.length - 1) / Math.floor((width - left - right) / 60)));
  for (let k = 0; k < values.length; k += every)
    add("text", { x: x(k), y: height - bottom + 16, "text-anchor": k === 0 ? "start" : k === values.length - 1 ? "end" : "middle" }, k);
  add("text", { x: (left + width - right) / 2, y: height - 3, "text-anchor": "middle" }, "iteration, those of the crash included");
  if (tolerance > 0) {
    const at = y(Math.log10(tolerance));
    add("line", { class: "tolerance", x1: left, x2: width - right, y1: at, y2: at });
    add("text", { class: "tolerance-name", x: left + 4, y: at - 5 }, "tolerance");
  }
  add("polyline", { class: "way", points: logs.map((log, k) => `${x(k)},${y(log)}`).join(" ") });
  if (values.length <= 60) logs.forEach((log, k) => add("circle", { class: "point", cx: x(k), cy: y(log), r: 3 }));
  $("plot").replaceChildren(svg);
}

function save(name, type, content) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([content], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

function csv() {
  const field = (value) => {
    const text = value === null || value === undefined ? "" : String(value);
    return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  return [result.columns.map(([name]) => name), ...result.rows].map((row) => `${row.map(field).join(",")}\r\n`).join("");
}

const saved_name = (ending) => `${problem.title.replace(/\.[^.]*$/, "").replace(/[^\w.-]+/g, "-")}-result.${ending}`;

// Begin.

async function begin() {
  show_examples();
  $("files").addEventListener("change", (event) => {
    take_files(event.target.files);
    event.target.value = ""; // so that the same file can be chosen again
  });
  for (const kind of ["dragenter", "dragover"])
    document.addEventListener(kind, (event) => {
      event.preventDefault();
      $("drop").classList.add("over");
    });
  for (const kind of ["dragleave", "drop"])
    document.addEventListener(kind, (event) => {
      event.preventDefault();
      $("drop").classList.remove("over");
    });
  document.addEventListener("drop", (event) => take_files(event.dataTransfer.files));
  $("solve-form").addEventListener("submit", (event) => {
    event.preventDefault();
    if (problem && !$("solve").disabled) solve();
  });
  $("stop").addEventListener("click", () => stop_run());
  $("filter").addEventListener("input", show_table);
  $("save-csv").addEventListener("click", () => save(saved_name("csv"), "text/csv", csv()));
  $("save-json").addEventListener("click", () => save(saved_name("json"), "application/json", JSON.stringify(result.json, null, 2)));
  try {
    const run = await perp(["methods", "--json"], {}, { stoppable: false });
    const all = JSON.parse(run.out);
    methods = all.methods.map((method) => method.name);
    $("version").textContent = `Perp ${perp_engine.version}, Apache License 2.0, with libraries under licences of their own (folder licences).`;
    show_methods();
  } catch (error) {
    refuse(`This browser cannot run the engine, which needs WebAssembly with exceptions: ${error.message}`);
  }
}

begin();
