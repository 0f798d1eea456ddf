// SPDX-License-Identifier: Apache-2.0
// Perp for JavaScript: a client of perp.h. Addresses are numbers, int64_t is BigInt.
import { run_program } from "./program.js";
import { System } from "./wasi.js";

const interface_ = 1000; // PERP_INTERFACE
const form = { columns: 0, dense_rows: 5 }; // perp_form
const stop = 2; // perp_evaluation
const kinds = { integer: 1, real: 2, text: 3, texts: 4, reals: 5, integers: 6, cells: 7, parts: 8, iterations: 9 };
const error_size = 1024, matrix_size = 40, iteration = { crash: 104 };

async function compile() {
  const url = new URL("perp.wasm", import.meta.url);
  if (url.protocol !== "file:") return WebAssembly.compileStreaming(fetch(url));
  const { readFile } = await import("node:fs/promises");
  return WebAssembly.compile(await readFile(url));
}

const callbacks = new Map(); // number to {F, J, log, thrown}
const module = await compile();
let system; // of the instance
let c; // its exports

function imports() {
  system = new System({ args: ["perp"] });
  return {
    wasi_snapshot_preview1: system.imports(),
    perp: {
      F: (n, x, F, user) => evaluate(user, "F", n, n, x, F),
      J: (count, x, value, user) => evaluate(user, "J", callbacks.get(user).n, count, x, value),
      log: (line, user) => {
        const own = callbacks.get(user);
        if (own.thrown === undefined && own.begun === c)
          try {
            own.log(text_at(line >>> 0));
          } catch (error) {
            own.thrown = { error };
          }
      },
    },
  };
}

function begin(instance) {
  c = instance.exports;
  system.memory = c.memory;
  c._initialize();
}
begin(await WebAssembly.instantiate(module, imports()));

/** Tells that the engine broke off: its memory and stack are then as the moment left them, and it has to begin anew. */
const broke = (error) => error instanceof WebAssembly.RuntimeError || (error instanceof RangeError && /stack/.test(error.message));

export class PerpError extends Error {
  constructor(code, message) {
    super(message);
    this.name = "PerpError";
    this.code = code;
  }
}

/** Reads an address that a function returns: WebAssembly gives those beyond 2 GB as negative numbers. */
const address = (name, ...words) => c[name](...words) >>> 0;
const view = () => new DataView(c.memory.buffer);
const reals_at = (pointer, count) => new Float64Array(c.memory.buffer, pointer >>> 0, count);

const decoder = new TextDecoder();
function text_at(pointer) {
  if (pointer === 0) return undefined;
  const bytes = new Uint8Array(c.memory.buffer, pointer);
  return decoder.decode(bytes.subarray(0, bytes.indexOf(0)));
}

/** F or J of the caller. An exception does not pass through the engine: it stops the solve, and is thrown after it. */
function evaluate(user, name, n, count, x, result) {
  const own = callbacks.get(user);
  if (own.thrown !== undefined || own.begun !== c) return stop;
  try {
    const values = own[name](reals_at(x, n).slice());
    if (own.begun !== c) return stop;
    if (values?.length !== count) throw new PerpError(4, `${name}: returned ${values?.length ?? typeof values} numbers in place of ${count}`);
    reals_at(result, count).set(values);
    return 0;
  } catch (error) {
    own.thrown = { error };
    return stop;
  }
}

/** Memory of the engine for what one call is given, freed at its end. */
class Arena {
  pointers = [];
  take(size) {
    const pointer = address("malloc", Math.max(8, size));
    if (pointer === 0) throw new PerpError(5, "out of memory");
    this.pointers.push(pointer);
    return pointer;
  }
  reals(values, name, count) {
    if (values === undefined) return 0;
    if (values.length !== count) throw new PerpError(1, `${name}: ${values.length} numbers in place of ${count}`);
    const pointer = this.take(8 * count);
    reals_at(pointer, count).set(values);
    return pointer;
  }
  integers(values) {
    const pointer = this.take(4 * values.length);
    new Int32Array(c.memory.buffer, pointer, values.length).set(values);
    return pointer;
  }
  text(value) {
    const bytes = new TextEncoder().encode(`${value}\0`);
    const pointer = this.take(bytes.length);
    new Uint8Array(c.memory.buffer, pointer, bytes.length).set(bytes);
    return pointer;
  }
  /** A perp_matrix, n x n: all places by rows, or those of the pattern, which stand in the order of `order`. */
  matrix(n, pattern, order, values) {
    const pointer = this.take(matrix_size);
    let start = 0, index = 0;
    if (pattern) {
      const starts = new Int32Array(n + 1);
      for (const [, column] of pattern) ++starts[column + 1];
      for (let j = 0; j < n; ++j) starts[j + 1] += starts[j];
      start = this.integers(starts);
      index = this.integers(order.map((k) => pattern[k][0]));
    }
    const at = view();
    at.setInt32(pointer, pattern ? form.columns : form.dense_rows, true);
    at.setInt32(pointer + 4, 0, true);
    at.setBigInt64(pointer + 8, BigInt(n), true);
    at.setBigInt64(pointer + 16, BigInt(n), true);
    at.setUint32(pointer + 24, start, true);
    at.setUint32(pointer + 28, index, true);
    at.setUint32(pointer + 32, values, true);
    return pointer;
  }
  free() {
    for (const pointer of this.pointers) c.free(pointer);
  }
}

/** The entries of a pattern, column by column. */
function by_columns(n, pattern) {
  for (const [row, column] of pattern)
    if (!(Number.isInteger(row) && Number.isInteger(column) && row >= 0 && row < n && column >= 0 && column < n))
      throw new PerpError(1, `pattern: there is no place [${row}, ${column}], n is ${n}`);
  return pattern.map((_, k) => k).sort((a, b) => pattern[a][1] - pattern[b][1]);
}

/** Calls a function of perp.h that returns a code and takes a perp_error as its last argument. */
function call(arena, name, ...words) {
  const error = arena.take(error_size);
  const code = c[name](...words, error);
  if (code !== 0) throw new PerpError(code, text_at(error + 4));
}

/** The same for those that make a handle. */
function make(arena, name, ...words) {
  const handle = arena.take(8);
  call(arena, name, ...words, handle);
  return view().getUint32(handle, true);
}

function iterations_of(result, key) {
  const count = Number(c.perp_result_length(result, key));
  let at = address("perp_result_iterations", result, key);
  const stride = count > 0 ? Number(view().getBigInt64(at, true)) : 0;
  return Array.from({ length: count }, () => {
    const memory = view(), own = at;
    at += stride;
    const real = (offset) => memory.getFloat64(own + offset, true), integer = (offset) => Number(memory.getBigInt64(own + offset, true));
    return {
      k: integer(8), residual: real(16), worst: integer(24), merit: real(32), step: real(40), prox: real(48), mu: real(56),
      pivots: integer(64), backtracks: integer(72), F_evals: integer(80), J_evals: integer(88),
      crash: memory.getInt32(own + iteration.crash, true) !== 0,
    };
  });
}

function field(result, key) {
  const count = Number(c.perp_result_length(result, key));
  const list = (get) => Array.from({ length: count }, (_, k) => get(result, key, BigInt(k)));
  switch (c.perp_result_kind(result, key)) {
    case kinds.integer:
      return Number(c.perp_result_integer(result, key));
    case kinds.real:
      return c.perp_result_real(result, key);
    case kinds.text:
      return text_at(address("perp_result_text", result, key, 0n));
    case kinds.texts:
      return list((...place) => text_at(address("perp_result_text", ...place)));
    case kinds.reals:
      return reals_at(address("perp_result_reals", result, key), count).slice();
    case kinds.integers:
      return Array.from(new BigInt64Array(c.memory.buffer, address("perp_result_integers", result, key), count), Number);
    case kinds.cells:
      return new Int8Array(c.memory.buffer, address("perp_result_cells", result, key), count).slice();
    case kinds.parts:
      return list((...place) => fields(address("perp_result_part", ...place)));
    case kinds.iterations:
      return iterations_of(result, key);
  }
}

/** All fields of a perp_result. */
function fields(result) {
  const object = {};
  for (let i = 0n; ; ++i) {
    const key = address("perp_result_key", result, i);
    if (key === 0) return object;
    const name = text_at(key), value = field(result, key);
    object[name] = name === "stats" || name === "computed" ? value[0] : value;
  }
}

/** Solves what `create(arena, user)` makes, and adds to the result what `more(problem, arena)` says. */
function run({ method, tolerance, timeLimit, options = {}, log }, own, create, x0, more = () => ({})) {
  const arena = new Arena();
  let user = 1;
  while (callbacks.has(user)) ++user;
  const begun = c; // another one once the engine has broken off, here or in a solve within
  callbacks.set(user, { ...own, log, begun });
  let problem = 0, solver = 0, result = 0;
  try {
    problem = create(arena, user);
    const n = Number(c.perp_problem_size(problem));
    solver = make(arena, "perp_solver_create", interface_);
    const given = { method, convergence_tolerance: tolerance, time_limit: timeLimit, ...options };
    for (const [key, value] of Object.entries(given))
      if (value !== undefined) call(arena, "perp_solver_set", solver, arena.text(key), arena.text(value));
    if (log) call(arena, "perp_solver_set_log", solver, c.perp_web_log(), user);
    const thrown = () => {
      const { thrown } = callbacks.get(user);
      if (thrown) throw thrown.error;
      if (c !== begun) throw new PerpError(7, "the engine broke off in a solve within this one");
    };
    try {
      result = make(arena, "perp_solve", solver, problem, arena.reals(x0, "x0", n));
    } catch (error) {
      thrown();
      throw error;
    }
    thrown();
    const all = fields(result);
    return { ...all, success: all.success === 1, ...more(problem, arena) };
  } catch (error) {
    if (c === begun && broke(error) && callbacks.get(user).thrown?.error !== error)
      begin(new WebAssembly.Instance(module, imports()));
    throw error;
  } finally {
    callbacks.delete(user);
    if (c === begun) {
      c.perp_result_free(result);
      c.perp_solver_free(solver);
      c.perp_problem_free(problem);
      arena.free();
    }
  }
}

export function solve(F, x0, { lower, upper, J, pattern, ...options } = {}) {
  const n = x0.length;
  const order = pattern && by_columns(n, pattern);
  const count = pattern ? pattern.length : n * n;
  const own = { n, F, J };
  if (J && pattern)
    own.J = (x) => {
      const values = J(x);
      return values?.length === count ? order.map((k) => values[k]) : values;
    };
  return run(options, own, (arena, user) =>
    make(arena, "perp_problem_create", interface_, BigInt(n), arena.reals(lower, "lower", n), arena.reals(upper, "upper", n),
      arena.matrix(n, pattern, order, 0), c.perp_web_F(), J ? c.perp_web_J() : 0, user), x0);
}

export function solveAffine(M, q, { lower, upper, pattern, ...options } = {}) {
  const n = q.length;
  const order = pattern && by_columns(n, pattern);
  const count = pattern ? pattern.length : n * n;
  if (M.length !== count) throw new PerpError(1, `M: ${M.length} numbers in place of ${count}`);
  const values = pattern ? order.map((k) => M[k]) : M;
  return run(options, { n }, (arena) =>
    make(arena, "perp_problem_affine", interface_, arena.matrix(n, pattern, order, arena.reals(values, "M", count)),
      arena.reals(q, "q", n), arena.reals(lower, "lower", n), arena.reals(upper, "upper", n)));
}

export function solveNl(nl, { row, col, ...options } = {}) {
  const names = ["model.nl", "model.row", "model.col"];
  [nl, row, col].forEach((bytes, k) => {
    if (!(bytes instanceof Uint8Array || (k > 0 && bytes === undefined))) throw new TypeError(`${names[k]} is no Uint8Array`);
  });
  [nl, row, col].forEach((bytes, k) => bytes && system.put(names[k], bytes));
  try {
    return run(options, {}, (arena) => make(arena, "perp_problem_read_nl", interface_, arena.text(names[0])), undefined,
      (problem, arena) => {
        const size = 1024, place = arena.take(size);
        const all = (name) =>
          Array.from({ length: Number(c.perp_problem_size(problem)) }, (_, i) => {
            call(arena, name, problem, BigInt(i), place, BigInt(size));
            return text_at(place);
          });
        return { names: { variables: all("perp_problem_variable_name"), equations: all("perp_problem_equation_name") } };
      });
  } finally {
    for (const name of names) system.remove(name);
  }
}

export async function program(words, files = {}) {
  const said = ["", ""];
  const run = await run_program(module, words, files, (stream, text) => (said[stream - 1] += text));
  return { code: run.code, out: said[0], err: said[1], files: run.files };
}

export const version = text_at(address("perp_version"));
