#include "app/comparison_report/page.hpp"

namespace perp::app::comparison {

/// Dark on white; the palette of Okabe & Ito without yellow, which is hard to see on white.
std::string_view page_style() {
  return R"css(
:root { --ink: #1a1a1a; --soft: #555; --line: #c8c8c8; --pale: #f3f5f7; --link: #004a80; --red: #a80000; }
* { box-sizing: border-box; }
[hidden] { display: none !important; }
html { -webkit-text-size-adjust: 100%; }
body { margin: 0 auto; max-width: 1320px; padding: 0 20px 60px; background: #fff; color: var(--ink);
  font: 15px/1.5 system-ui, "DejaVu Sans", "Liberation Sans", Arial, sans-serif; }
h1 { font-size: 27px; line-height: 1.2; margin: 28px 0 4px; }
h2 { font-size: 21px; margin: 44px 0 6px; padding-top: 10px; border-top: 2px solid var(--ink); }
h3 { font-size: 17px; margin: 30px 0 4px; }
h4 { font-size: 15px; margin: 14px 0 2px; }
p { margin: 6px 0 10px; max-width: 86em; }
.sub, .note { color: var(--soft); }
.note { font-size: 13.5px; }
a { color: var(--link); }
code { font: 13px/1.4 "DejaVu Sans Mono", monospace; overflow-wrap: anywhere; }
nav { display: flex; flex-wrap: wrap; gap: 2px 16px; margin: 12px 0; font-size: 14px; }
.findings { border-left: 4px solid #0072B2; padding: 2px 0 2px 14px; margin: 14px 0; }
.findings p { max-width: 82em; margin: 5px 0; }
.alarm { border: 2px solid var(--red); border-left-width: 10px; padding: 4px 14px 10px; margin: 14px 0; color: var(--red); }
.alarm table { color: var(--ink); }
.alarm .scroll { max-height: 340px; overflow-y: auto; }
.alarm td.bad, td.bad, th.bad { color: var(--red); font-weight: 700; white-space: nowrap; }
.fine { border-left: 4px solid #009E73; padding: 2px 0 2px 14px; margin: 14px 0; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 13.5px; margin: 8px 0; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: 600; padding: 4px 0; }
th, td { padding: 3px 9px; border-bottom: 1px solid #e3e3e3; text-align: left; vertical-align: top; }
thead th { border-bottom: 1.5px solid var(--ink); background: #fff; vertical-align: bottom; line-height: 1.25; }
tbody th { font-weight: 500; white-space: nowrap; }
tfoot th, tfoot td { border-top: 1.5px solid var(--ink); color: var(--soft); }
.n { text-align: right; white-space: nowrap; }
td.total { font-weight: 700; }
.dense { font-size: 12.5px; }
.dense th, .dense td { padding: 3px 5px; }
.dense tbody th { white-space: normal; overflow-wrap: anywhere; min-width: 11em; }
td.none { color: #767676; }
tbody tr:hover { background: var(--pale); }
thead th button { font: inherit; font-weight: 600; color: inherit; background: none; border: 0; padding: 0; cursor: pointer;
  text-align: inherit; border-bottom: 1px dotted #777; }
thead th button:hover { text-decoration: underline; }
th[aria-sort=ascending] button::after { content: "\2191"; }
th[aria-sort=descending] button::after { content: "\2193"; }
:focus-visible { outline: 3px solid #0072B2; outline-offset: 2px; }
input, select, .more button { font: inherit; font-size: 14px; padding: 4px 8px; border: 1px solid #777; border-radius: 4px;
  background: #fff; color: var(--ink); }
input[type=search] { width: 26em; max-width: 100%; }
select { max-width: 100%; }
.controls { display: flex; flex-wrap: wrap; gap: 8px 14px; align-items: center; margin: 8px 0; }
.controls label { display: inline-flex; gap: 6px; align-items: center; max-width: 100%; }
.more button { cursor: pointer; }
.more button[disabled] { color: #767676; border-color: #ccc; cursor: default; }
.legend { display: flex; flex-wrap: wrap; gap: 4px 6px; margin: 8px 0; padding: 0; list-style: none; }
.legend button { display: inline-flex; align-items: center; gap: 6px; font: inherit; font-size: 13px; padding: 1px 8px;
  border: 1px solid #999; border-radius: 12px; background: #fff; color: var(--ink); cursor: pointer; }
.legend button[aria-pressed=false] { color: #6a6a6a; border-style: dashed; }
.legend button[aria-pressed=false] svg { opacity: .35; }
.legend svg { width: 34px; height: 12px; flex: none; }
.charts { display: grid; grid-template-columns: 1fr 1fr; gap: 4px 16px; }
.charts > div { overflow-x: auto; }
.charts svg, #curves svg { display: block; width: 100%; min-width: 520px; height: auto; }
#curves svg { min-width: 760px; }
.tabs > input { position: absolute; opacity: 0; width: 1px; height: 1px; }
.tabs > label { display: inline-block; padding: 3px 12px; margin: 4px 4px 8px 0; border: 1px solid #777; border-radius: 4px;
  font-size: 14px; cursor: pointer; }
.tabs > input:checked + label { background: var(--ink); color: #fff; }
.tabs > input:focus-visible + label { outline: 3px solid #0072B2; outline-offset: 2px; }
.tabs > .pane { display: none; }
.tabs > .t0:checked ~ .p0, .tabs > .t1:checked ~ .p1, .tabs > .t2:checked ~ .p2 { display: block; }
svg text { font: 12px system-ui, "DejaVu Sans", "Liberation Sans", Arial, sans-serif; fill: var(--ink); }
svg .title { font-weight: 600; font-size: 13.5px; }
svg .grid { stroke: #e2e2e2; stroke-width: 1; }
svg .axis { stroke: #333; stroke-width: 1.2; }
svg .line { fill: none; stroke-width: 2; stroke-linejoin: round; }
svg .leader { fill: none; stroke-width: .8; }
svg .hollow { fill: #fff; stroke-width: 1.8; }
svg .stroke { stroke-width: 2; }
.c0 { stroke: #0072B2; } .c1 { stroke: #D55E00; } .c2 { stroke: #000000; } .c3 { stroke: #009E73; }
.c4 { stroke: #CC79A7; } .c5 { stroke: #E69F00; } .c6 { stroke: #56B4E9; }
.f0 { fill: #0072B2; stroke: #0072B2; } .f1 { fill: #D55E00; stroke: #D55E00; } .f2 { fill: #000000; stroke: #000000; }
.f3 { fill: #009E73; stroke: #009E73; } .f4 { fill: #CC79A7; stroke: #CC79A7; } .f5 { fill: #E69F00; stroke: #E69F00; }
.f6 { fill: #56B4E9; stroke: #56B4E9; }
.d1 { stroke-dasharray: 9 4; } .d2 { stroke-dasharray: 2.5 3; } .d3 { stroke-dasharray: 12 3 2.5 3; }
g.muted .line { stroke: #b5b5b5; stroke-width: 1; }
g.muted .marker { opacity: 0; }
g.muted .leader { stroke: #c8c8c8; }
g.muted .label { fill: #6a6a6a; }
.lit g.curve:not(.strong) { opacity: .22; }
g.strong .line { stroke-width: 3.2; }
#cells table { width: 100%; font-size: 12px; }
#cells th, #cells td { padding: 2px 5px; }
#cells td.message { min-width: 14em; max-width: 30em; overflow-wrap: anywhere; }
#cells td.o, #cells th, #cells td.w { white-space: nowrap; }
#curves text.label { paint-order: stroke; stroke: #fff; stroke-width: 3px; stroke-linejoin: round; }
#cells button.show { font: inherit; color: var(--link); background: none; border: 0; padding: 0; cursor: pointer;
  text-decoration: underline; text-align: left; white-space: nowrap; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 2px 18px; font-size: 14px; }
dt { color: var(--soft); }
dd { margin: 0; overflow-wrap: anywhere; }
.skip { position: absolute; left: -999px; }
.skip:focus { left: 8px; top: 8px; background: #fff; padding: 4px 8px; }
@media (max-width: 1000px) { .charts { grid-template-columns: 1fr; } }
@media (max-width: 600px) {
  body { padding: 0 12px 40px; font-size: 15px; }
  dl { grid-template-columns: 1fr; } dt { margin-top: 6px; }
  input[type=search] { width: 100%; }
  .controls label { width: 100%; }
  .controls select { flex: 1; min-width: 0; }
}
@media print {
  @page { size: A4 landscape; margin: 11mm; }
  body { max-width: none; padding: 0; line-height: 1.4; font-size: 9pt; }
  h1 { margin-top: 0; } h2 { break-after: avoid; margin-top: 18pt; } h3, h4, caption { break-after: avoid; }
  nav, .controls, .legend, .more, .skip, .screen, .tabs > label { display: none; }
  .note { break-after: avoid; }
  .tabs > .pane { display: block; }
  .scroll, .alarm .scroll, .charts > div { overflow: visible; max-height: none; }
  .charts { grid-template-columns: 1fr 1fr; break-inside: avoid; }
  section.comparison:not(#cfunctions + *, #profiles + *), #robustness, #unsolvable, #profiles, #cfunctions, #convergence, #cells { break-before: page; }
  .charts svg { min-width: 0; max-height: 70mm; }
  #curves svg { min-width: 0; max-height: 140mm; }
  thead th button { border-bottom: 0; }
  thead th button::after { content: "" !important; }
  table { font-size: 7.5pt; line-height: 1.25; } th, td { padding: 1.5pt 4pt; }
  thead { display: table-header-group; } tr, svg { break-inside: avoid; }
  #cells table { font-size: 6pt; } #cells th, #cells td { padding: 1pt 2.5pt; }
  #cells td.message { min-width: 0; }
  #cells button.show { color: inherit; text-decoration: none; }
  #cells .n { white-space: normal; }
  .dense { font-size: 7pt; } .dense th, .dense td { padding: 1.3pt 3pt; } .dense tbody th { min-width: 0; white-space: nowrap; }
  * { -webkit-print-color-adjust: exact; print-color-adjust: exact; }
}
)css";
}

}  // namespace perp::app::comparison
