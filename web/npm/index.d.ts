// SPDX-License-Identifier: Apache-2.0

/** Numbers, of any kind of array. */
export type Numbers = ArrayLike<number>;

/** A place in a Jacobian or matrix: row and column, from 0. */
export type Place = readonly [row: number, column: number];

export interface Options {
  /** "auto", "path", ...: `perp methods` lists them. */
  method?: string;
  /** On the natural residual; 1e-8. */
  tolerance?: number;
  /** In seconds; 3600. */
  timeLimit?: number;
  /** Others of `perp methods`, by name: { crash_method: "none" }. */
  options?: Record<string, string | number>;
  /** Gets each line of the log. */
  log?: (line: string) => void;
}

export interface Bounds {
  /** Default 0 everywhere; -Infinity is free. */
  lower?: Numbers;
  /** Default Infinity everywhere. */
  upper?: Numbers;
}

export interface Model extends Bounds, Options {
  /** The Jacobian of F: all entries by rows, or with `pattern` those, in its order. Default: differences of F. */
  J?: (x: Float64Array) => Numbers;
  /** The places of J that can be nonzero, each once. */
  pattern?: readonly Place[];
}

export interface Iteration {
  k: number;
  /** Natural residual of the iterate. */
  residual: number;
  /** The row where it is largest; -1: none. */
  worst: number;
  merit: number;
  step: number;
  prox: number;
  mu: number;
  pivots: number;
  backtracks: number;
  F_evals: number;
  J_evals: number;
  /** A step of the crash, which is no major iteration. */
  crash: boolean;
}

export type Status =
  | "Solved" | "SolvedToRounding" | "Infeasible" | "StationaryPoint" | "NoProgress" | "Stalled" | "Ray" | "Unbounded"
  | "Singular" | "LinearAlgebraFailed" | "SubproblemFailed" | "EvaluationFailed" | "NotApplicable" | "IterationLimit"
  | "TimeLimit" | "Interrupted" | "NoMemory";

/** Fields as in perp.h, perp_solve(). */
export interface Result {
  status: Status;
  /** The natural residual is at most the tolerance. */
  success: boolean;
  message: string;
  advice: string;
  /** The best point met, and F there. */
  x: Float64Array;
  F: Float64Array;
  /** Natural residual of x, by the judge, and the row where it is largest; -1: none. */
  residual: number;
  worst: number;
  /** What a solution to the tolerance leaves to be said. */
  notes?: string[];
  stats: Record<string, number>;
  log: Iteration[];
  /** Of Infeasible: no point has a natural residual of at most this. */
  residual_bound?: number;
  /** Of Infeasible: the proof, as JSON. */
  certificate?: string;
}

/** Thrown where arguments, options or a file make no sense. */
export class PerpError extends Error {
  /** perp_code of perp.h. */
  code: number;
  constructor(code: number, message: string);
}

/** Finds x in [lower, upper] with F_i(x) >= 0 where x_i is at its lower bound, <= 0 at its upper one, = 0 between, from
 *  x0. What F or J throws is thrown again. */
export function solve(F: (x: Float64Array) => Numbers, x0: Numbers, model?: Model): Result;

/** The same for F(x) = M x + q; M by rows, all n n entries, or with `pattern` the values of those places. */
export function solveAffine(M: Numbers, q: Numbers, model?: Bounds & Options & { pattern?: readonly Place[] }): Result;

/** The complementarity problem of an AMPL model, an .nl file; its names are in `names`, from the .row and .col files. */
export function solveNl(
  nl: Uint8Array,
  model?: Options & { row?: Uint8Array; col?: Uint8Array },
): Result & { names: { variables: string[]; equations: string[] } };

/** Runs the program, `perp solve model.nl --json result.json`, on files in memory, in an instance of its own. */
export function program(
  words: readonly string[],
  files?: Record<string, Uint8Array>,
): Promise<{ code: number; out: string; err: string; files: Record<string, Uint8Array> }>;

/** Of the engine. */
export const version: string;
