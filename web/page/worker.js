// SPDX-License-Identifier: Apache-2.0
import { run_program } from "../engine/program.js";

/** One run of the program. What it prints is told every 50 ms, since a page cannot show lines as fast as they come. */
onmessage = async ({ data: { module, args, files } }) => {
  let lines = [], told = 0;
  const tell = () => {
    if (lines.length > 0) postMessage({ lines });
    lines = [];
    told = performance.now();
  };
  try {
    const { code, files: after } = await run_program(module, args, files, (stream, text) => {
      lines.push([stream, text]);
      if (performance.now() - told > 50) tell();
    });
    tell();
    postMessage({ code, files: after });
  } catch (error) {
    tell();
    postMessage({ broke: String(error) });
  }
};
