// SPDX-License-Identifier: Apache-2.0
import { Exit, System } from "./wasi.js";

/** Imports of the engine beside WASI: functions that are called back. The program has none. */
const no_callbacks = { F: () => -1, J: () => -1, log: () => {} };

/** Runs the program `perp` with these words and files, in an instance of its own: whatever happens in it ends with it.
 *  write(stream, text) gets what it prints, 1 is output, 2 errors. Returns the exit code and the files there are then. */
export async function run_program(module, args, files, write) {
  const decoders = [1, 2].map(() => new TextDecoder());
  const system = new System({
    args: ["perp", ...args],
    files,
    write: (stream, bytes) => write(stream, decoders[stream - 1].decode(bytes, { stream: true })),
  });
  const instance = await WebAssembly.instantiate(module, {
    wasi_snapshot_preview1: system.imports(),
    perp: no_callbacks,
  });
  system.memory = instance.exports.memory;
  let code;
  try {
    instance.exports._initialize();
    code = instance.exports.__main_void();
  } catch (error) {
    if (!(error instanceof Exit)) throw error;
    code = error.code;
  }
  return { code, files: system.contents() };
}
