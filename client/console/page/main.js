// The page: which cell, which plan, which grasp; everything else follows from these.
import { by_id, set_text } from './dom.js';
import { get_history, listen, make_loader } from './feed.js';
import * as cells_view from './cells_view.js';
import * as depth_view from './depth_view.js';
import * as history_view from './history_view.js';
import * as pile_view from './pile_view.js';
import * as plan_view from './plan_view.js';

const kHistoryPace_ms = 500;
const kReplayPace_ms = 700;

const cells = new Map();
let chosen_cell = null;
let history = [];
let is_live = true;
let player = null;
let flight = null;
let grasps = [];
let selected = null;
let lit = new Set();
let scene = null;
let is_scene_asked = false;

const line_of = (name) => history.find((line) => line.flight === name);

// ---- what is shown of a plan

function target_id() {
  return selected?.grasp.object_id;
}

function show_selection() {
  depth_view.show(flight, grasps, selected, lit);
  scene?.show(flight, grasps, selected, target_id(), lit);
}

function light(ids) {
  lit = new Set(ids);
  plan_view.light_grs(lit);
  pile_view.light(lit);
  if (flight) show_selection();
}

function select_grasp(entry) {
  selected = entry;
  show_plan_lists();
  show_selection();
}

function select_object(id) {
  const entry = grasps.find((candidate) => candidate.grasp.object_id === id);
  if (entry) select_grasp(entry);
}

function show_plan_lists() {
  plan_view.show_grasps(grasps, selected, flight.answer?.funnel);
  plan_view.show_grs(flight.answer, target_id(), light, select_object);
  plan_view.light_grs(lit);
  pile_view.show(flight, target_id(), select_object);
  pile_view.light(lit);
}

// What became of the plan may be known later than the plan.
function show_fate() {
  const line = line_of(flight.name);
  const was_at = grasps.indexOf(selected);
  const was_picked = grasps.some((entry) => entry.is_picked);
  grasps = plan_view.grasps_of(flight, line?.pick);
  const picked = grasps.find((entry) => entry.is_picked);
  selected = (picked && !was_picked ? picked : grasps[was_at]) ?? grasps[0] ?? null;
  plan_view.show_outcome(flight, line?.pick, cells.get(chosen_cell));
  plan_view.show_times(flight.answer, line?.pick);
  show_plan_lists();
}

function show_flight(next) {
  if (next.cell !== chosen_cell) return;
  flight = next;
  selected = null;
  grasps = [];
  lit = new Set();
  show_fate();
  plan_view.show_funnel(flight.answer?.funnel);
  show_selection();
  history_view.mark(flight.name);
  show_when();
  by_id('stage').dataset.flight = flight.name;
  start_scene();
  document.dispatchEvent(new CustomEvent('planshown', { detail: { flight: flight.name, stamp_s: flight.stamp_s } }));
}

function fail_flight(name, error) {
  set_text(by_id('when'), error.message.includes('no longer kept') ? 'This plan is no longer kept.' : '');
}

function show_when() {
  if (!flight) return;
  const at = new Date(1000 * flight.stamp_s).toLocaleTimeString('en-GB');
  set_text(by_id('when'), is_live ? cells_view.ago(flight.stamp_s) : `replay · ${at}`);
}

const load = make_loader(show_flight, fail_flight);

// ---- which plan

function set_live(on) {
  is_live = on;
  by_id('live').setAttribute('aria-pressed', on);
  if (on) stop_playing();
  const newest = cells.get(chosen_cell)?.plan?.flight;
  if (on && newest && flight?.name !== newest) load(newest);
  show_when();
}

function go_to(name) {
  set_live(false);
  load(name);
}

function step(by) {
  const at = history.findIndex((line) => line.flight === flight?.name);
  const line = history[at + by];
  if (at < 0 || !line) return false;
  go_to(line.flight);
  return true;
}

function stop_playing() {
  clearInterval(player);
  player = null;
  by_id('play').setAttribute('aria-pressed', 'false');
}

function play() {
  if (player) return stop_playing();
  const is_at_end = history.at(-1)?.flight === flight?.name;
  if (history.length > 0 && is_at_end) go_to(history[0].flight);
  by_id('play').setAttribute('aria-pressed', 'true');
  player = setInterval(() => step(1) || stop_playing(), kReplayPace_ms);
}

// ---- which cell

let history_timer = null;
function refresh_history() {
  history_timer ??= setTimeout(async () => {
    history_timer = null;
    const cell = chosen_cell;
    try {
      const lines = await get_history(cell);
      if (cell !== chosen_cell) return;
      history = lines;
    } catch {
      return;  // the stream says so
    }
    history_view.show(history);
    set_text(by_id('history_note'), history.length ? `${history.length} plans kept` : '');
    if (!flight || flight.cell !== chosen_cell) return;
    history_view.mark(flight.name);
    const pick = line_of(flight.name)?.pick;
    if (pick && pick.request_id !== flight.fate) {
      flight.fate = pick.request_id;
      show_fate();
      show_selection();
    }
  }, history.length === 0 ? 0 : kHistoryPace_ms);
}

function choose_cell(name) {
  if (name === chosen_cell) return;
  chosen_cell = name;
  history = [];
  flight = null;
  set_text(by_id('cell_name'), name);
  cells_view.mark_cell(name);
  set_live(true);
  refresh_history();
  location.replace(`#${encodeURIComponent(name)}`);
}

function on_cell(cell) {
  cells.set(cell.cell, cell);
  cells_view.show_cell(cell);
  const asked_for = decodeURIComponent(location.hash.slice(1));
  if (!chosen_cell && (!asked_for || asked_for === cell.cell)) choose_cell(cell.cell);
  if (cell.cell !== chosen_cell) return;
  refresh_history();
  if (is_live && cell.plan && cell.plan.flight !== flight?.name) load(cell.plan.flight);
}

// ---- the rest of the page

function on_servers(servers) {
  const ready = servers.filter((server) => server.health?.state === 'READY');
  const busy_n = ready.reduce((sum, { health }) => sum + health.workers_busy_n, 0);
  const workers_n = ready.reduce((sum, { health }) => sum + health.workers_n, 0);
  const target = by_id('servers');
  target.classList.toggle('down', ready.length < servers.length);
  const down = servers.filter((server) => server.health?.state !== 'READY');
  const names = down.map((server) => `${server.endpoint} ${server.health?.state?.toLowerCase() ?? 'is not there'}`);
  set_text(target, [`${ready.length} of ${servers.length} server${servers.length === 1 ? '' : 's'} ready`,
    ...(workers_n ? [`${busy_n} of ${workers_n} worker${workers_n === 1 ? '' : 's'} busy`] : []), ...names].join(' · '));
  target.title = target.textContent;
}

function on_link(state, was_lost) {
  const link = by_id('link');
  if (link.dataset.state !== state) {
    link.dataset.state = state;
    set_text(link, state === 'live' ? 'Live' : 'No connection to the console. Trying again …');
    document.body.classList.toggle('is_dead', state === 'lost');
  }
  if (was_lost && chosen_cell) refresh_history();
}

function set_theme(theme) {
  document.documentElement.dataset.theme = theme;
  scene?.recolour();
}

function start_theme() {
  const system = matchMedia('(prefers-color-scheme: dark)');
  const now = () => localStorage.getItem('theme') ?? (system.matches ? 'dark' : 'light');
  set_theme(now());
  system.addEventListener('change', () => set_theme(now()));
  by_id('theme').addEventListener('click', () => {
    const next = now() === 'dark' ? 'light' : 'dark';
    localStorage.setItem('theme', next);
    set_theme(next);
  });
}

// After the first plan is there: it is by far the largest thing to load.
async function start_scene() {
  if (is_scene_asked) return;
  is_scene_asked = true;
  try {
    const { make_scene } = await import('./scene_view.js');
    scene = make_scene();
  } catch (error) {
    console.info(error);
    const note = by_id('scene_note');
    note.hidden = false;
    note.textContent = 'This browser has no WebGL, so there is no 3D view. All else works.';
    return;
  }
  document.querySelector('.tools').addEventListener('click', ({ target }) => {
    if (target.dataset.view) scene.look_from(target.dataset.view);
    if (!target.dataset.toggle) return;
    const on = target.getAttribute('aria-pressed') !== 'true';
    target.setAttribute('aria-pressed', on);
    scene.toggle(target.dataset.toggle, on);
  });
  if (flight) show_selection();
}

function on_key(event) {
  if (event.target.matches('input') || event.ctrlKey || event.metaKey || event.altKey) return;
  const is_button = event.target.matches('button');
  const actions = { ArrowLeft: () => step(-1), ArrowRight: () => step(1), l: () => set_live(true) };
  if (!is_button) actions[' '] = play;
  const action = actions[event.key];
  if (!action) return;
  event.preventDefault();
  action();
}

start_theme();
cells_view.start(choose_cell);
plan_view.start(select_grasp);
history_view.start(go_to);
depth_view.start(() => flight && show_selection());
by_id('back').addEventListener('click', () => step(-1));
by_id('forth').addEventListener('click', () => step(1));
by_id('play').addEventListener('click', play);
by_id('live').addEventListener('click', () => set_live(true));
document.addEventListener('keydown', on_key);
setInterval(() => {
  cells_view.show_ages();
  show_when();
}, 1000);
listen({ on_cell, on_servers, on_link });
