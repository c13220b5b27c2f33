// A bar for each kept plan of the cell, as high as it took long; replay steps through them.
import { by_id, element, make_listbox, reveal, select_option } from './dom.js';
import { milliseconds } from './cells_view.js';

const strip = by_id('history');
const kHighest_ms = 150;

export function fate_of(line) {
  if (line.code !== 'OK') return 'failed';
  if (line.pick?.verdict) return line.pick.verdict === 'PLACED' ? 'placed' : 'failed';
  return line.pick || line.grasps_n === 0 ? 'nothing' : 'open';
}

const clock = (stamp_s) => new Date(1000 * stamp_s).toLocaleTimeString('en-GB');

export function describe(line) {
  const what = line.pick?.verdict ? `grasp ${line.pick.rank} ${line.pick.verdict.toLowerCase()}`
                                  : (line.pick?.outcome || line.outcome || line.code).toLowerCase().replaceAll('_', ' ');
  return `${clock(line.stamp_s)} · ${what} · ${milliseconds(line.server_ms)}`;
}

const known = new Map();
export function show(history) {
  const is_at_end = strip.scrollLeft + strip.clientWidth >= strip.scrollWidth - 30;
  const highest = Math.max(kHighest_ms, ...history.map((line) => line.server_ms));
  const names = new Set(history.map((line) => line.flight));
  for (const [name, bar] of known) {
    if (names.has(name)) continue;
    bar.remove();
    known.delete(name);
  }
  history.forEach((line, i) => {
    let bar = known.get(line.flight);
    if (!bar) {
      bar = element('div', { role: 'option', 'aria-selected': 'false', id: `plan_${line.flight}` }, element('span'));
      known.set(line.flight, bar);
    }
    bar.line = line;
    const fate = fate_of(line);
    const text = describe(line);
    if (bar.className !== fate) bar.className = fate;
    if (bar.title !== text) {
      bar.title = text;
      bar.setAttribute('aria-label', text);
    }
    const height = `${Math.round(30 * Math.sqrt(line.server_ms / highest))}px`;
    if (bar.firstChild.style.height !== height) bar.firstChild.style.height = height;
    if (strip.children[i] !== bar) strip.insertBefore(bar, strip.children[i] ?? null);
  });
  if (is_at_end) strip.scrollLeft = strip.scrollWidth;
}

export function mark(name) {
  const bar = known.get(name);
  select_option(strip, bar);
  if (bar) reveal(strip, bar);
}

export const start = (choose) => make_listbox(strip, (bar) => choose(bar.line.flight));
