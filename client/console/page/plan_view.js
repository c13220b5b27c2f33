// The plan in words and figures: outcome, grasps, GRS, funnel, time.
import { by_id, element, make_listbox, reveal, select_option } from './dom.js';
import { milliseconds } from './cells_view.js';

const kOutcomes = {
  PLANNED: ['good', 'planned'], UNCHANGED: ['good', 'unchanged'], BIN_EMPTY: ['quiet', 'bin empty'],
  BIN_NOT_FOUND: ['bad', 'bin not found'], NONE_REGISTERED: ['bad', 'nothing recognised'],
  ALL_IN_COLLISION: ['bad', 'all in collision'], NONE_REACHABLE: ['bad', 'none reachable'],
};
const kStages = [
  ['pixels', 'pixels_n'], ['with a reading', 'readings_n'], ['inside the bin', 'after_passthrough_n'],
  ['after the voxel grid', 'after_voxel_grid_n'], ['above the floor', 'after_plane_n'], ['segments', 'segments_n'],
  ['poses tried', 'hypotheses_n'], ['parts recognised', 'registered_n'], ['grasps free', 'grasps_n'],
];
const kRejections = [
  ['too wide or narrow', 'rejected_opening_n'], ['gripper in what was seen', 'rejected_gripper_cloud_n'],
  ['gripper in another part', 'rejected_gripper_parts_n'], ['gripper in bin', 'rejected_gripper_bin_n'],
  ['held part would touch', 'rejected_held_part_n'],
];
const count = (n) => Math.round(n).toLocaleString('en');
const sentence = (text) => `${text[0].toUpperCase()}${text.slice(1)}.`;
const plural = (n, what) => `${count(n)} ${what}${n === 1 ? '' : 's'}`;

// The answer's grasps, each with what speaks against it.
export function grasps_of(flight, pick) {
  const passed_over = new Map(pick?.passed_over ?? []);
  const part_of = new Map((flight.answer?.objects ?? []).map((object) => [object.id, object.part_id]));
  const free = (flight.answer?.grasps ?? []).map((grasp, i) => ({
    grasp, rank: i + 1, part: part_of.get(grasp.object_id), kind: passed_over.has(i + 1) ? 'unreachable' : 'free',
    reason: passed_over.get(i + 1) ?? '', is_picked: pick?.rank === i + 1 && pick.verdict !== '',
  }));
  const rejected = (flight.answer?.rejected_grasps ?? []).map((grasp) => ({
    grasp, rank: null, part: part_of.get(grasp.object_id), kind: 'colliding', is_picked: false,
    reason: grasp.checks.find((check) => check.state === 'FAILED')?.reason ?? '',
  }));
  return [...free, ...rejected];
}

export function show_outcome(flight, pick, summary) {
  const tag = by_id('outcome');
  const words = by_id('words');
  if (!flight.answer) {
    tag.dataset.kind = 'bad';
    tag.textContent = flight.code.toLowerCase().replaceAll('_', ' ');
    words.textContent = flight.message;
    return;
  }
  const { reason, warnings, grasps, objects, fill_level } = flight.answer;
  const outcome = pick?.outcome || flight.answer.outcome;  // the server does not know the arm
  const [kind, text] = kOutcomes[outcome] ?? ['quiet', outcome];
  tag.dataset.kind = kind;
  tag.textContent = text;
  const sentences = [];
  if (grasps.length > 0) sentences.push(`${plural(grasps.length, 'grasp')} on ${plural(objects.length, 'part')}.`);
  if (reason) sentences.push(sentence(reason));
  if (fill_level !== undefined) sentences.push(`The bin is ${Math.round(100 * fill_level)} % full.`);
  if (pick?.verdict) {
    sentences.push(`The arm took grasp ${pick.rank}: ${pick.verdict.toLowerCase()} after ${pick.cycle_s.toFixed(1)} s.`);
  } else if (pick?.message && pick.message !== reason) {
    sentences.push(sentence(pick.message));
  }
  for (const warning of warnings ?? []) sentences.push(sentence(warning));
  if (summary?.alarm) sentences.push(`Drift alarm: ${summary.alarm}.`);
  words.textContent = sentences.join(' ').replaceAll('..', '.');
}

const grasp_list = by_id('grasps');
export function show_grasps(grasps, selected, funnel) {
  const scroll = grasp_list.scrollTop;
  grasp_list.replaceChildren(...grasps.map((entry, i) => {
    const name = `${entry.part ?? 'part'} ${entry.grasp.object_id} · ${entry.grasp.pick_point}`;
    const said = entry.is_picked ? 'picked' : `${(1000 * entry.grasp.opening_width_m).toFixed(0)} mm`;
    const option = element('li', { role: 'option', id: `grasp_${i}`, class: entry.kind, 'aria-selected': 'false',
        title: entry.reason || `score ${entry.grasp.score.toFixed(3)}` },
      element('span', { class: 'unseen', text: entry.kind }),
      element('span', { class: 'rank', text: entry.rank ?? '' }),
      element('span', { class: 'what', text: entry.reason ? `${name}: ${entry.reason}` : name }),
      element('span', { class: entry.is_picked ? 'picked' : '', text: said }));
    option.entry = entry;
    return option;
  }));
  grasp_list.scrollTop = scroll;
  const option = grasp_list.children[grasps.indexOf(selected)];
  select_option(grasp_list, option);
  if (option) reveal(grasp_list, option);
  const rejected_n = kRejections.reduce((sum, [, key]) => sum + (funnel?.[key] ?? 0), 0);
  const listed_n = grasps.filter((entry) => entry.kind === 'colliding').length;
  by_id('grasp_note').textContent = grasps.length === 0 ? 'None.'
    : rejected_n > listed_n ? `${plural(rejected_n - listed_n, 'more candidate')} failed a check${listed_n ? '.' : '; explain_rejected in a request brings some along.'}` : '';
}

// α and β stand in the server's configuration, not in the answer: any two objects give them away.
const weights = new Map();
function weights_of(answer) {
  let [aa, ab, bb, as, bs] = [0, 0, 0, 0, 0];
  for (const { grs } of answer.objects) {
    if (!(grs.p_system > 0)) continue;
    const [a, b, s] = [grs.p_self ?? 0, grs.p_grasp ?? 0, (grs.grs ?? 0) / grs.p_system];
    aa += a * a; ab += a * b; bb += b * b; as += a * s; bs += b * s;
  }
  const determinant = aa * bb - ab * ab;
  const key = answer.server?.config_hash;
  if (determinant > 1e-9 * aa * bb) {
    weights.set(key, [(as * bb - bs * ab) / determinant, (aa * bs - ab * as) / determinant]);
    if (weights.size > 16) weights.delete(weights.keys().next().value);
  }
  return weights.get(key) ?? [1, 0];
}

export function show_grs(answer, target, light, choose) {
  const list = by_id('grs');
  const objects = [...(answer?.objects ?? [])].sort((a, b) => b.grs.grs - a.grs.grs);
  const [alpha, beta] = answer ? weights_of(answer) : [1, 0];
  const terms = objects.map(({ grs }) => [alpha * grs.p_self, beta * grs.p_grasp].map((term) => Math.max(0, term)));
  const most = Math.max(1e-9, ...terms.map(([self, near]) => self + near));
  list.replaceChildren(...objects.map((object, i) => {
    const { grs } = object;
    const [self, near] = terms[i];
    const share = (value) => `${(100 * value) / most}%`;
    const segment = (kind, value) => {
      const made = element('span', { class: `seg ${kind}` });
      made.style.width = share(value);
      return made;
    };
    const row = element('li', { class: object.id === target ? 'is_target' : '', 'data-id': object.id,
        title: `P_self ${grs.p_self.toFixed(4)}, P_grasp ${grs.p_grasp.toFixed(5)}, P_system ${grs.p_system.toFixed(3)}; `
          + `${(1000 * grs.height_m).toFixed(0)} mm high, load ${grs.load.toFixed(2)}, cover ${grs.cover.toFixed(2)}` },
      element('button', { type: 'button', text: String(object.id), 'aria-label': `Part ${object.id}, score ${grs.grs.toFixed(3)}` }),
      element('span', { class: 'track' }, segment('self', self * grs.p_system), segment('near', near * grs.p_system),
        segment('lost', (self + near) * (1 - grs.p_system))),
      element('span', { class: 'value', text: grs.grs.toFixed(3) }));
    row.addEventListener('pointerenter', () => light(grs.neighbour_ids ?? []));
    row.addEventListener('pointerleave', () => light([]));
    row.firstChild.addEventListener('focus', () => light(grs.neighbour_ids ?? []));
    row.firstChild.addEventListener('blur', () => light([]));
    row.addEventListener('click', () => choose(object.id));
    return row;
  }));
}

export function light_grs(lit) {
  for (const row of by_id('grs').children) row.classList.toggle('is_lit', lit.has(Number(row.dataset.id)));
}

export function show_funnel(funnel) {
  const body = by_id('funnel').tBodies[0];
  if (!funnel) return body.replaceChildren();
  const most = Math.log10(1 + Math.max(...kStages.map(([, key]) => funnel[key] ?? 0)));
  const line = (label, n, kind) => {
    const bar = element('span');
    bar.style.width = `${(100 * Math.log10(1 + n)) / most}%`;
    return element('tr', { class: kind }, element('th', { scope: 'row', text: label }),
      element('td', {}, element('span', { class: 'track thin', title: 'logarithmic' }, bar)),
      element('td', { class: 'n', text: count(n) }));
  };
  const rejected = kRejections.filter(([, key]) => funnel[key] > 0);
  body.replaceChildren(...kStages.map(([label, key]) => line(label, funnel[key] ?? 0, '')),
    ...rejected.map(([label, key]) => line(label, funnel[key], 'minor')));
}

export function show_times(answer, pick) {
  const target = by_id('times');
  const stages = (answer?.timings ?? []).map((timing) => [timing.stage, Number(timing.duration_ns) / 1e6]);
  const sum = stages.reduce((total, [, ms]) => total + ms, 0);
  if (sum === 0) return target.replaceChildren();
  const bar = element('div', { class: 'track' }, ...stages.map(([stage, ms], i) => {
    const part = element('span', { class: `seg stage_${i % 8}`, title: `${stage} ${milliseconds(ms)}` });
    part.style.width = `${(100 * ms) / sum}%`;
    return part;
  }));
  const item = (kind, label, ms) =>
    element('li', {}, element('i', { class: kind }), element('span', { text: label }), element('b', { text: milliseconds(ms) }));
  target.replaceChildren(bar, element('ul', {}, ...stages.map(([stage, ms], i) => item(`stage_${i % 8}`, stage, ms)),
    item('', 'server, in all', sum), ...(pick?.plan_ms ? [item('', 'seen by the cell', pick.plan_ms)] : [])));
}

export function start(choose) {
  make_listbox(grasp_list, (option) => choose(option.entry));
}
