//! The style sheet of the page, for screens in light and dark mode and for paper.

pub(super) const STYLE: &str = r"
:root {
  color-scheme: light dark;
  --page: #ffffff; --ink: #1d1d1f; --soft: #6b6b70; --line: #e3e3e6; --plate: #f6f6f7;
  --reflectance: #9b9ba1; --fluorescence: #f58a1f; --unreachable: #b3157f; --no-color: #00b4d0;
}
@media (prefers-color-scheme: dark) {
  :root {
    --page: #161618; --ink: #ececef; --soft: #9d9da4; --line: #333338; --plate: #202023;
    --reflectance: #7d7d84; --fluorescence: #f79a3a; --unreachable: #d9359e; --no-color: #00c8e6;
  }
}
* { box-sizing: border-box; }
body {
  margin: 0; background: var(--page); color: var(--ink);
  font: 15px/1.5 system-ui, 'Segoe UI', 'Helvetica Neue', Arial, sans-serif;
  font-variant-numeric: tabular-nums;
}
main { max-width: 1040px; margin: 0 auto; padding: 40px 28px 56px; }
h1, .picture { font-size: 27px; line-height: 1.2; font-weight: 650; margin: 0; overflow-wrap: anywhere; }
.section { font-size: 16px; font-weight: 650; margin: 34px 0 8px; }
.scroll { overflow-x: auto; }
p { margin: 6px 0; }
a { color: inherit; }
code { font: 0.92em ui-monospace, Consolas, monospace; background: var(--plate); padding: 1px 4px; border-radius: 4px; }
small, .facts, .note, .fine, figcaption { color: var(--soft); }
.note, figcaption { font-size: 13px; }
.verdict { font-size: 19px; line-height: 1.35; margin: 20px 0 2px; }
.overview { margin-bottom: 56px; }
.overview h1 { margin-bottom: 16px; }
.overview td { vertical-align: middle; }
.overview .wide { width: 34%; }
.overview .bar { margin: 0; height: 12px; }
article + article { margin-top: 64px; padding-top: 44px; border-top: 1px solid var(--line); }
.bar { display: flex; gap: 2px; height: 22px; margin: 20px 0 10px; border-radius: 5px; overflow: hidden; }
.bar span { flex-basis: 0; min-width: 3px; }
.reflectance { background: var(--reflectance); }
.fluorescence { background: var(--fluorescence); }
.unreachable { background: var(--unreachable); }
.no-color { background: var(--no-color); }
.shares { display: flex; flex-wrap: wrap; gap: 2px 30px; list-style: none; margin: 0; padding: 0; }
.key { display: inline-block; width: 11px; height: 11px; border-radius: 3px; margin-right: 8px; }
.pictures { display: grid; grid-template-columns: 1fr 1fr; gap: 24px; margin-top: 24px; }
figure { margin: 0; min-width: 0; }
figure img {
  display: block; width: 100%; height: auto; max-height: 460px;
  object-fit: contain; object-position: left top; border-radius: 4px;
}
img.texels { image-rendering: pixelated; }
figcaption { margin: 8px 0 10px; }
.ramp { display: flex; align-items: flex-start; gap: 14px; font-size: 13px; margin-bottom: 4px; height: 30px; }
.ramp span { flex: 0 0 140px; line-height: 14px; white-space: nowrap; color: var(--soft); }
.ramp.plain { height: 22px; }
.ramp i { position: relative; flex: 1; height: 12px; border-radius: 3px; font-style: normal; }
.ramp i.gray { background: linear-gradient(to right, #292929, #d1d1d1); }
.ramp b { position: absolute; top: 13px; transform: translateX(-50%); font-weight: 400; font-size: 12px; color: var(--soft); }
.ramp b:last-child { transform: translateX(-100%); }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; vertical-align: middle; padding: 5px 14px 5px 0; border-bottom: 1px solid var(--line); font-weight: 400; }
thead th { color: var(--soft); font-size: 13px; }
.number { text-align: right; padding-right: 26px; white-space: nowrap; }
.name { white-space: nowrap; }
.why { min-width: 200px; }
.place { white-space: nowrap; margin-right: 18px; }
.swatch { display: inline-block; width: 54px; height: 22px; border-radius: 4px; margin-right: 10px; vertical-align: middle; }
@media (max-width: 640px) {
  main { padding: 24px 16px 40px; }
  .pictures { grid-template-columns: 1fr; }
  table { font-size: 13px; }
  .swatch { width: 28px; }
}
@media print {
  @page { size: A4; margin: 12mm; }
  :root {
    --page: #ffffff; --ink: #000000; --soft: #55555a; --line: #d5d5d8; --plate: #f2f2f3;
    --reflectance: #9b9ba1; --fluorescence: #f58a1f; --unreachable: #b3157f; --no-color: #00b4d0;
  }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  body { font-size: 10.5px; }
  main { padding: 0; max-width: none; }
  h1, .picture { font-size: 19px; }
  .section { font-size: 12px; margin: 12px 0 3px; break-after: avoid; }
  .verdict { font-size: 13px; margin-top: 8px; }
  .bar { height: 13px; margin: 10px 0 6px; }
  .pictures { grid-template-columns: 1fr 1fr; gap: 14px; margin-top: 12px; }
  figure img { max-height: 82mm; }
  figcaption, .note, .ramp, thead th { font-size: 9px; }
  .ramp { height: 22px; }
  .ramp.plain { height: 16px; }
  .ramp span { flex-basis: 92px; }
  .ramp b { font-size: 8.5px; }
  th, td { padding: 1.5px 10px 1.5px 0; }
  .swatch { height: 12px; width: 40px; }
  .overview, article { break-after: page; break-inside: avoid; }
  article:last-child { break-after: auto; }
  article + article { margin: 0; padding: 0; border: 0; }
}
";
