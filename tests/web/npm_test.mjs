// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { PerpError, program, solve, solveAffine, solveNl, version } from "perp";

const near = (actual, expected, tolerance = 1e-7) =>
  actual.forEach((value, i) => assert.ok(Math.abs(value - expected[i]) <= tolerance, `[${i}]: ${value}, not ${expected[i]}`));

// Kojima & Shindo (1986) with the solution (sqrt(6)/2, 0, 0, 1/2) and, degenerate, (1, 0, 3, 0).
const kojima_shindo = ([a, b, c, d]) => [
  3 * a * a + 2 * a * b + 2 * b * b + c + 3 * d - 6, 2 * a * a + a + b * b + 10 * c + 2 * d - 2,
  3 * a * a + a * b + 2 * b * b + 2 * c + 9 * d - 9, a * a + 3 * b * b + 2 * c + 3 * d - 3,
];

test("a nonlinear problem, by differences", () => {
  const lines = [];
  const result = solve(kojima_shindo, [0, 0, 0, 0], { log: (line) => lines.push(line) });
  assert.equal(result.status, "Solved");
  assert.equal(result.success, true);
  assert.ok(result.residual <= 1e-8);
  result.x.forEach((x, i) => assert.ok(Math.abs(Math.min(x, kojima_shindo(result.x)[i])) <= 1e-7));
  near(result.F, kojima_shindo(result.x), 1e-12);
  assert.ok(result.stats.F_evals > 0 && result.log.length > 0 && result.log.at(-1).residual <= 1e-8);
  assert.ok(lines.some((line) => line.includes("Major Iteration Log")));
});

test("a Jacobian by rows and by its pattern, and bounds", () => {
  // x - 2 on [0, 1] is at its upper bound; y = e^-y / 2 inside.
  const F = ([x, y]) => [x - 2, 2 * y - Math.exp(-y)];
  const bounds = { lower: [0, -Infinity], upper: [1, Infinity] };
  const known = [1, 0.35173371124919584];
  const dense = solve(F, [0, 0], { ...bounds, J: ([, y]) => [1, 0, 0, 2 + Math.exp(-y)] });
  const sparse = solve(F, [0, 0], { ...bounds, J: ([, y]) => [2 + Math.exp(-y), 1], pattern: [[1, 1], [0, 0]] });
  for (const result of [dense, sparse]) near(result.x, known);
});

test("affine problems", () => {
  near(solveAffine([2, 1, 1, 2], [-5, -6]).x, [4 / 3, 7 / 3]);
  near(solveAffine([2, 1, 1, 2], [1, -6]).x, [0, 3]);
  near(solveAffine([2, 1, 1, 2], [-5, -6], { pattern: [[1, 1], [0, 1], [1, 0], [0, 0]] }).x, [4 / 3, 7 / 3]);
  // -x - 1 >= 0 has no x >= 0.
  const none = solveAffine([-1], [-1]);
  assert.equal(none.status, "Infeasible");
  assert.ok(none.residual_bound > 0 && JSON.parse(none.certificate));
});

test("what is thrown comes back", () => {
  const mine = new RangeError("mine");
  assert.throws(() => solve(() => { throw mine; }, [1]), (error) => error === mine);
  assert.throws(() => solve(() => [1, 2], [1]), /F: returned 2 numbers in place of 1/);
  assert.throws(() => solve(kojima_shindo, [0, 0, 0, 0], { method: "slove" }), PerpError);
  assert.throws(() => solve(kojima_shindo, [0, 0, 0, 0], { lower: [0] }), /lower: 1 numbers in place of 4/);
  assert.throws(() => solveAffine([1], [NaN]), PerpError);
  assert.throws(() => solveNl(new Uint8Array(3)), PerpError);
  assert.throws(() => solve((x) => x, [1], { J: () => [1], pattern: [[0, 1]] }), /there is no place \[0, 1\]/);
  near(solve((x) => [x[0] - 1], [0]).x, [1]); // and nothing is left behind
});

// 4 GB are all that 32 bits reach: catches sizes that overflow there.
test("more memory than there is", () => {
  for (const n of [20000, 46000]) assert.throws(() => solve((x) => x, new Float64Array(n)), /need [0-9.]+ GB, 4.3 GB are available/);
  near(solve((x) => [x[0] - 1], [0]).x, [1]);
});

test("a solve within a solve", () => {
  const inner = (a) => solve(([x]) => [x * x * x - a], [1], { lower: [-Infinity] }).x[0];
  near(solve(([x]) => [inner(x) - 2], [1]).x, [8], 1e-5);
});

const models = process.env.PERP_MODELS;
test("a model of AMPL", { skip: !models && "PERP_MODELS is not set" }, async () => {
  const [nl, row, col] = ["nl", "row", "col"].map((ending) => new Uint8Array(readFileSync(`${models}/cournot.${ending}`)));
  const known = JSON.parse(readFileSync(`${models}/cournot.sol.json`));
  const result = solveNl(nl, { row, col });
  near(result.names.variables.map((name, i) => result.x[i] - known[name]), [0, 0, 0, 0, 0], 1e-6);
  const run = await program(["solve", "cournot.nl", "--json", "out.json"], { "cournot.nl": nl, "cournot.row": row, "cournot.col": col });
  assert.equal(run.code, 0, run.err);
  assert.equal(JSON.parse(new TextDecoder().decode(run.files["out.json"])).status, "Solved");
  assert.match(run.out, /Solved: solution found/);
  assert.equal((await program(["solve", "absent.nl"])).code, 2);
  // Deeper than the stack of Node: the engine breaks off, and the next solve is as the first.
  const text = new TextDecoder().decode(nl).replace("C0\n", `C0\n${"o16\n".repeat(9990)}`);
  for (let k = 0; k < 2; ++k) {
    assert.throws(() => solveNl(new TextEncoder().encode(text)), RangeError);
    near(solveNl(nl).x, result.x, 1e-9);
  }
  // The same in a solve within a solve: this one cannot go on, whether F minds or not.
  const deep = () => solveNl(new TextEncoder().encode(text));
  assert.throws(() => solve(([x]) => (deep(), [x]), [1]), RangeError);
  assert.throws(() => solve(([x]) => { try { deep(); } catch {} return [x - 1]; }, [3]), /broke off in a solve within/);
  near(solveNl(nl).x, result.x, 1e-9);
});

test("memory is given back", () => {
  const before = process.memoryUsage().arrayBuffers;
  for (let k = 0; k < 2000; ++k) solveAffine([2, 1, 1, 2], [-5, -6]);
  assert.ok(process.memoryUsage().arrayBuffers - before < 32e6);
  assert.match(version, /^\d+\.\d+\.\d+$/);
});
