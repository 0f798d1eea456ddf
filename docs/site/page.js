// SPDX-License-Identifier: Apache-2.0
// Renders ```math blocks and $`...`$ by KaTeX, which katex.min.js has made global; narrow cells of tables.
document.addEventListener("DOMContentLoaded", () => {
  const shown = (tex, displayMode) => {
    const node = document.createElement("span");
    katex.render(tex, node, { displayMode, throwOnError: false });
    return node;
  };
  for (const code of document.querySelectorAll("code.language-math")) {
    const block = document.createElement("div");
    block.className = "formula";
    const tex = code.textContent;
    // Parts may wrap where the formula is no environment of its own.
    for (const part of tex.includes("\\begin") ? [tex] : tex.split("\\qquad")) block.append(shown(part, true));
    (code.closest("pre") ?? code).replaceWith(block);
  }
  for (const code of document.querySelectorAll("code")) {
    const before = code.previousSibling;
    const after = code.nextSibling;
    if (before?.nodeType !== Node.TEXT_NODE || after?.nodeType !== Node.TEXT_NODE) continue;
    if (!before.data.endsWith("$") || !after.data.startsWith("$")) continue;
    before.data = before.data.slice(0, -1);
    after.data = after.data.slice(1);
    code.replaceWith(shown(code.textContent, false));
  }
  // Numbers like 12 / 15 stay in one line.
  for (const cell of document.querySelectorAll("td")) cell.classList.toggle("short", cell.textContent.length < 14);
});
