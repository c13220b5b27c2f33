#pragma once

namespace graspd::onboarding {

/// Of the report's page.
inline constexpr const char* kPageStyle = R"css(
:root { color-scheme: light dark; --ground: #ffffff; --plate: #f4f5f7; --line: #d5d9df; --text: #1b1f26;
  --soft: #565e6b; --good: #0b6e4f; --fair: #8a5a00; --poor: #b3261e; --accent: #0b5cad; }
@media (prefers-color-scheme: dark) { :root { --ground: #14171c; --plate: #1e232b; --line: #363d48;
  --text: #e8eaee; --soft: #a5adba; --good: #5fd3a6; --fair: #f0b955; --poor: #ff8a80; --accent: #7ab8ff; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--ground); color: var(--text); font: 16px/1.5 system-ui, sans-serif; }
main { max-width: 60rem; margin: 0 auto; padding: 1.5rem 1rem 3rem; }
h1 { font-size: 1.5rem; margin: 0 0 .25rem; }
h2 { font-size: 1.15rem; margin: 2.25rem 0 .6rem; }
p { margin: .4rem 0; max-width: 46rem; }
.soft, figcaption small, td small { color: var(--soft); }
.verdict { border-left: .4rem solid; padding: .7rem 1rem; margin: 1rem 0; background: var(--plate);
  font-size: 1.1rem; border-radius: .25rem; }
.verdict b { display: block; }
.good { border-color: var(--good); } .good b { color: var(--good); }
.fair { border-color: var(--fair); } .fair b { color: var(--fair); }
.poor { border-color: var(--poor); } .poor b { color: var(--poor); }
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(11rem, 45%), 1fr)); gap: .8rem; }
figure { margin: 0; break-inside: avoid; }
figure img { width: 100%; height: auto; display: block; border-radius: .25rem; }
figcaption { margin-top: .3rem; line-height: 1.35; }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; padding: .4rem .7rem .4rem 0; border-bottom: 1px solid var(--line); vertical-align: top; }
th { font-weight: 600; }
.scroll { overflow-x: auto; }
.number { white-space: nowrap; }
@media screen and (max-width: 36rem) {
  .figures tr { display: grid; grid-template-columns: 1fr 6rem 6.5rem; border-bottom: 1px solid var(--line); }
  .figures th, .figures td { border: 0; } .figures th:nth-child(4) { display: none; }
  .figures td:nth-child(4) { grid-column: 1 / -1; padding-top: 0; color: var(--soft); } }
.warning { color: var(--fair); font-weight: 600; }
pre { background: var(--plate); padding: .8rem 1rem; overflow-x: auto; border-radius: .25rem; white-space: pre-wrap;
  overflow-wrap: anywhere; font-size: .9rem; }
li { margin: .3rem 0; max-width: 46rem; }
footer { margin-top: 2.5rem; color: var(--soft); font-size: .9rem; }
@media print { :root { color-scheme: light; --ground: #fff; --plate: #f4f5f7; --line: #bbb; --text: #000;
  --soft: #444; --good: #0b6e4f; --fair: #8a5a00; --poor: #b3261e; }
  body { font-size: 11pt; } main { max-width: none; padding: 0; } h2 { break-after: avoid; }
  .verdict, tr { break-inside: avoid; } * { print-color-adjust: exact; -webkit-print-color-adjust: exact; } }
)css";

}  // namespace graspd::onboarding
