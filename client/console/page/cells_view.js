// The list of cells: a row is changed only where its figures do.
import { by_id, element, make_listbox, reveal, select_option, set_text } from './dom.js';

const kQuiet_s = 30;
const list = by_id('cells');
const rows = new Map();

export const seconds = (s) => (s === undefined || s === null ? '–' : s < 10 ? `${s.toFixed(1)} s` : `${Math.round(s)} s`);
export const milliseconds = (ms) => (ms === undefined || ms === null ? '–' : `${ms < 10 ? ms.toFixed(1) : Math.round(ms)} ms`);
export function ago(stamp_s) {
  const s = Math.max(0, Date.now() / 1000 - stamp_s);
  if (s < 2) return 'now';
  if (s < 120) return `${Math.round(s)} s ago`;
  if (s < 7200) return `${Math.round(s / 60)} min ago`;
  return s < 172800 ? `${Math.round(s / 3600)} h ago` : `${Math.round(s / 86400)} days ago`;
}

// What the cell does, in a kind and a word or two.
export function state_of(cell) {
  const age_s = cell.plan ? Date.now() / 1000 - cell.plan.stamp_s : Infinity;
  if (cell.run_state === 'STOPPED') return ['trouble', 'stopped'];
  if (cell.plan && cell.plan.code !== 'OK') return ['trouble', 'refused'];
  if (cell.alarm) return ['trouble', 'drift alarm'];
  if (cell.run_state === 'DONE') return ['done', 'done'];
  if (age_s < kQuiet_s) return ['working', cell.run_state ? 'picking' : 'planning'];
  return ['quiet', cell.plan ? ago(cell.plan.stamp_s) : 'no plan yet'];
}

function make_row(name) {
  const cells = {};
  const figure = (key, label) =>
    element('div', {}, element('dt', { text: label }), (cells[key] = element('dd', { text: '–' })));
  const row = element('li', { role: 'option', 'aria-selected': 'false', id: `cell_${rows.size}` },
    element('div', { class: 'head' }, (cells.name = element('span', { class: 'name', text: name, title: name })),
      (cells.state = element('span', { class: 'state' }))),
    element('dl', {}, figure('picks', 'placed'), figure('success', 'success'), figure('cycle', 'cycle'),
      figure('latency', 'plan')));
  row.cells = cells;
  row.name = name;
  rows.set(name, row);
  const after = [...list.children].find((other) => other.name.localeCompare(name, 'en', { numeric: true }) > 0);
  list.insertBefore(row, after ?? null);
  return row;
}

export function show_cell(cell) {
  const row = rows.get(cell.cell) ?? make_row(cell.cell);
  row.cell = cell;
  const [kind, word] = state_of(cell);
  if (row.dataset.state !== kind) row.dataset.state = kind;
  set_text(row.cells.state, word);
  set_text(row.cells.picks, cell.picks_n ? `${cell.placed_n} / ${cell.picks_n}` : '–');
  set_text(row.cells.success, cell.picks_n ? `${Math.floor((100 * cell.placed_n) / cell.picks_n)} %` : '–');
  set_text(row.cells.cycle, seconds(cell.cycle_s));
  set_text(row.cells.latency, milliseconds(cell.round_trip_ms ?? cell.plan?.server_ms));
  by_id('no_cells').hidden = true;
}

export function show_ages() {
  for (const row of rows.values()) show_cell(row.cell);
}

export function mark_cell(name) {
  const row = rows.get(name);
  select_option(list, row);
  if (row) reveal(list, row);
}

export function start(choose) {
  make_listbox(list, (row) => choose(row.name));
  by_id('filter').addEventListener('input', (event) => {
    const part = event.target.value.trim().toLowerCase();
    for (const [name, row] of rows) row.hidden = !name.toLowerCase().includes(part);
  });
}
