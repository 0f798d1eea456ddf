#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// web.mjs PERP NPM [RUNS]: times of the npm package in the folder NPM, in Node, beside the program PERP, as rows of a table:
// the time that each states of its own solve, the least of so many runs in turns (default 5), and their ratio.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const [perp, npm, runs = "5"] = process.argv.slice(2);
if (npm === undefined) {
  console.error("web.mjs PERP NPM [RUNS]");
  process.exit(2);
}
const { program } = await import(pathToFileURL(resolve(npm, "index.js")));
const data = join(dirname(dirname(fileURLToPath(import.meta.url))), "data");
const problems = [
  ...["cournot", "economy", "energy", "growth", "harberger", "spatial", "streets"].map((name) => join(data, "models", `${name}.nl`)),
  ...["arch-13-falling", "spheres-15"].map((name) => join(data, "contact", `${name}.hdf5`)),
  "obstacle:50x50", "obstacle:150x150", "journal-bearing", "bratu-own", "american-put-own", "vanderpol-own-1000",
  "lq-control-own-10000", "traffic-own-4860", "spatial-price-own-1138", "random-pd-own-1000", "random-monotone-ncp-own-1000",
];
const folder = mkdtempSync(join(tmpdir(), "perp-web-"));

/** Runs and lets fail: the exit code of a problem that is not solved is 1. */
function native(words) {
  const out = join(folder, "native.json");
  try {
    execFileSync(perp, [...words, "--json", out], { stdio: "ignore" });
  } catch (error) {
    if (error.status !== 1) throw error;
  }
  return JSON.parse(readFileSync(out, "utf8"));
}

async function web(words, files) {
  const run = await program([...words, "--json", "out.json"], files);
  if (run.code > 1) throw new Error(run.err);
  return JSON.parse(new TextDecoder().decode(run.files["out.json"]));
}

const least = (values) => Math.min(...values);
const shown = (seconds) => (seconds < 0.1 ? `${(1e3 * seconds).toPrecision(3)} ms` : `${seconds.toPrecision(3)} s`);
const ratios = [];
console.log("| problem | n | native: status, iterations | native | web: status, iterations | web | ratio |\n|---|---|---|---|---|---|---|");
for (const problem of problems) {
  const file = problem.includes("/");
  const command = problem.endsWith(".hdf5") ? "contact" : "solve";
  const files = file ? { [basename(problem)]: new Uint8Array(readFileSync(problem)) } : {};
  const times = [[], []];
  let own, other;
  for (let k = 0; k < Number(runs); ++k) {
    own = native([command, problem]);
    other = await web([command, basename(problem)], files);
    times[0].push(own.stats.time_s);
    times[1].push(other.stats.time_s);
  }
  const ratio = least(times[1]) / least(times[0]);
  ratios.push(ratio);
  const how = (json) => `${json.status}, ${json.stats.iterations}`;
  const size = own.size ?? own.contacts.length * own.dimension;
  console.log(`| ${basename(problem)} | ${size} | ${how(own)} | ${shown(least(times[0]))} | ${how(other)} | ${shown(least(times[1]))} | ${ratio.toFixed(2)} |`);
}
ratios.sort((a, b) => a - b);
console.log(`\nmedian of the ratios ${((ratios[9] + ratios[10]) / 2).toFixed(2)}, from ${ratios[0].toFixed(2)} to ${ratios.at(-1).toFixed(2)}`);
rmSync(folder, { recursive: true });
