#pragma once
// The style sheet of all reports. Colours of series (c0 to c5) can be distinguished in print and by colour-blind
// readers.

namespace vbar::report {

inline constexpr const char* kStyleSheet = R"css(
:root {
  --page: #fcfcfb; --ink: #1a1a19; --muted: #63625d; --grid: #e6e5e0; --frame: #c3c2b7; --panel: #f4f3ef;
  --good: #1a7a3c; --caution: #9a6700; --bad: #c0291f;
  --c0: #2a78d6; --c1: #e0560f; --c2: #10916a; --c3: #b98400; --c4: #6a4fc4; --c5: #7a7973;
}
@media (prefers-color-scheme: dark) {
  :root {
    --page: #1a1a19; --ink: #f2f1ec; --muted: #b4b2a8; --grid: #33322f; --frame: #55534d; --panel: #242422;
    --good: #5bc27e; --caution: #d4a72c; --bad: #ff7a6e;
    --c0: #5a9df0; --c1: #f58a4b; --c2: #35bd92; --c3: #d9a520; --c4: #a794f5; --c5: #a09e95;
  }
}
@media print {
  :root {
    --page: #fff; --ink: #000; --muted: #444; --grid: #ddd; --frame: #999; --panel: #fff;
    --good: #1a7a3c; --caution: #9a6700; --bad: #c0291f;
    --c0: #2a78d6; --c1: #e0560f; --c2: #10916a; --c3: #b98400; --c4: #6a4fc4; --c5: #7a7973;
  }
}
@page { size: A4; margin: 14mm; }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink); font: 15px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
main { max-width: 1240px; margin: 0 auto; padding: 28px 24px 64px; }
h1 { font-size: 28px; line-height: 1.2; margin: 0 0 4px; }
h2 { font-size: 19px; margin: 40px 0 10px; padding-top: 12px; border-top: 1px solid var(--grid); }
h3 { font-size: 15px; margin: 20px 0 6px; }
p { margin: 6px 0; max-width: 90ch; }
.lead, .note { color: var(--muted); }
.status { display: inline-block; padding: 1px 10px; border-radius: 10px; border: 1px solid; font-size: 13px; }
.good { color: var(--good); } .caution { color: var(--caution); } .bad { color: var(--bad); }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 10px; margin: 18px 0; }
.tile { background: var(--panel); border: 1px solid var(--grid); border-radius: 6px; padding: 10px 14px; }
.tile b { display: block; font-size: 22px; line-height: 1.25; font-weight: 600; }
.tile span { color: var(--muted); font-size: 13px; overflow-wrap: anywhere; }
nav { display: flex; flex-wrap: wrap; gap: 2px 18px; font-size: 14px; margin: 12px 0; }
a { color: var(--c0); text-decoration: none; } a:hover { text-decoration: underline; }
.files { font-size: 13px; color: var(--muted); }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 14px; font-variant-numeric: tabular-nums; margin: 8px 0; }
th, td { padding: 4px 14px 4px 0; text-align: left; vertical-align: top; }
th { color: var(--muted); font-weight: 600; border-bottom: 1px solid var(--frame); vertical-align: bottom; max-width: 12em; }
td { border-bottom: 1px solid var(--grid); }
th.number, td.number { text-align: right; padding: 4px 0 4px 22px; white-space: nowrap; }
th.number { white-space: normal; }
td.number + td:not(.number), th.number + th:not(.number) { padding-left: 22px; }
td code { white-space: nowrap; }
th.group { color: var(--ink); padding-top: 14px; max-width: none; }
dl { display: grid; grid-template-columns: repeat(auto-fit, minmax(440px, 1fr)); gap: 0 36px; margin: 8px 0; font-size: 14px; }
dl div { display: flex; gap: 14px; padding: 3px 0; border-bottom: 1px solid var(--grid); }
dt { color: var(--muted); flex: 0 0 180px; }
dd { margin: 0; overflow-wrap: anywhere; font-variant-numeric: tabular-nums; }
code { font: 12.5px ui-monospace, "DejaVu Sans Mono", monospace; }
details { margin: 8px 0; } summary { cursor: pointer; color: var(--muted); }
.figures > .legend { grid-column: 1 / -1; }
.figures { display: grid; gap: 10px 16px; margin: 8px 0 14px; }
@media (min-width: 760px), print {
  .of2 { grid-template-columns: repeat(2, minmax(0, 1fr)); } .of3 { grid-template-columns: repeat(3, minmax(0, 1fr)); }
  .of4 { grid-template-columns: repeat(4, minmax(0, 1fr)); }
}
figure { margin: 0; }
.picture { display: block; width: 100%; height: auto; }
.mark { fill: none; stroke-width: 1.4; vector-effect: non-scaling-stroke; pointer-events: all; }
.mark.red { stroke: #e62828; } .mark.green { stroke: #28d23c; } .mark.blue { stroke: #4678ff; } .mark.white { stroke: #fff; }
 figcaption { font-size: 13px; color: var(--muted); }
.legend { font-size: 13px; color: var(--muted); display: flex; flex-wrap: wrap; gap: 2px 20px; margin: 4px 0; }
.swatch { width: 24px; height: 10px; margin-right: 6px; }
svg.plot { display: block; width: 100%; height: auto; font-size: 11px; }
svg text { fill: var(--ink); }
svg .title { font-size: 12px; font-weight: 600; }
svg .tick { fill: var(--muted); font-size: 10.5px; } svg .name { fill: var(--muted); }
svg .mid { text-anchor: middle; } svg .end { text-anchor: end; }
svg .frame { fill: none; stroke: var(--frame); } svg .grid { stroke: var(--grid); }
svg line.moment { stroke: var(--muted); stroke-dasharray: 2 3; } svg text.moment { fill: var(--muted); font-size: 10px; }
svg .event { fill: none; stroke: var(--c4); stroke-width: 1.4; }
svg .line { fill: none; stroke-width: 1.3; stroke-linejoin: round; }
svg .line.broad { stroke-width: 4.5; stroke-opacity: 0.4; } svg .dots.broad { stroke-width: 6; stroke-opacity: 0.35; } svg .dashed { stroke-dasharray: 5 3; }
svg .dots { fill: none; stroke-width: 3.4; stroke-linecap: round; }
svg .dots.cells { stroke-width: 7.4; } svg .area { fill-opacity: 0.18; stroke: none; }
svg .s0 { stroke-opacity: 0.14; } svg .s1 { stroke-opacity: 0.3; } svg .s2 { stroke-opacity: 0.5; } svg .s3 { stroke-opacity: 0.72; }
svg .c0 { stroke: var(--c0); } svg .c1 { stroke: var(--c1); } svg .c2 { stroke: var(--c2); }
svg .c3 { stroke: var(--c3); } svg .c4 { stroke: var(--c4); } svg .c5 { stroke: var(--c5); }
svg .f0 { fill: var(--c0); } svg .f1 { fill: var(--c1); } svg .f2 { fill: var(--c2); }
svg .f3 { fill: var(--c3); } svg .f4 { fill: var(--c4); } svg .f5 { fill: var(--c5); } svg .f6 { fill: var(--bad); }
svg circle.ring { fill: var(--page); fill-opacity: 0.35; stroke: var(--bad); stroke-width: 1.4; }
svg text.ring { fill: var(--bad); font-size: 10.5px; font-weight: 600; }
@media print {
  body { font-size: 11px; } h1 { font-size: 20px; } h2 { font-size: 14px; margin: 20px 0 6px; } h3 { font-size: 12px; }
  main { max-width: none; padding: 0; }
  table, dl, .legend { font-size: 10px; }
  th.number, td.number { padding-left: 10px; }
  .tiles { grid-template-columns: repeat(6, 1fr); gap: 6px; margin: 10px 0; }
  .tile { padding: 5px 8px; } .tile b { font-size: 13px; } .tile span { font-size: 10px; }
  dl { grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 0 20px; } dt { flex-basis: 120px; }
  .scroll { overflow: visible; }
  figure, .figures, .keep, table, tr, dl, dl div, .tile { break-inside: avoid; }
  h2, h3, .keep, .note, thead { break-after: avoid; }
  nav, .files { font-size: 10px; }
  svg .title { font-size: 14px; } svg.plot, svg .tick { font-size: 12.5px; }
  svg text.moment, svg text.ring { font-size: 12px; }
}
)css";

}  // namespace vbar::report
