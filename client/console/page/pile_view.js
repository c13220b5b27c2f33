// Who lies on whom, seen from above: each part at its place in the bin.
import { by_id, element } from './dom.js';
import { inverse, matrix_of, shown_frame, transform } from './geometry.js';

const kUnit = 1000;  // millimetres
const kRadius = 13;

function arrow(from, to, kind) {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(dx, dy);
  if (length < 2 * kRadius) return [];
  const [ux, uy] = [dx / length, dy / length];
  const start = [from[0] + ux * kRadius, from[1] + uy * kRadius];
  const tip = [to[0] - ux * (kRadius + 1), to[1] - uy * (kRadius + 1)];
  const line = element('svg:line', { class: `edge ${kind}`, x1: start[0], y1: start[1], x2: tip[0], y2: tip[1] });
  if (kind) return [line];
  const wing = (side) => `${tip[0] - 9 * ux + side * 5 * uy},${tip[1] - 9 * uy - side * 5 * ux}`;
  return [line, element('svg:polygon', { class: 'head', points: `${tip[0]},${tip[1]} ${wing(1)} ${wing(-1)}` })];
}

export function show(flight, target, choose) {
  const objects = flight.answer?.objects ?? [];
  const T = inverse(shown_frame(flight.request));
  const size = flight.request.bin?.inner_size_m ?? flight.request.crop_box?.size_m ?? { x: 0.4, y: 0.3 };
  const [width, height] = [size.x * kUnit, size.y * kUnit];
  const at = new Map(objects.map((object) => {
    const t = matrix_of(object.T_base_part);
    const [x, y] = transform(T, [t[3], t[7], t[11]]);
    return [object.id, [x * kUnit, -y * kUnit]];
  }));
  const edges = objects.flatMap((object) => [
    ...(object.lies_on_ids ?? []).flatMap((id) => (at.has(id) ? arrow(at.get(object.id), at.get(id), '') : [])),
    ...(object.entangled_ids ?? []).flatMap((id) =>
      (at.has(id) && id > object.id ? arrow(at.get(object.id), at.get(id), 'entangled') : [])),
  ]);
  const nodes = objects.map((object) => {
    const [x, y] = at.get(object.id);
    const node = element('svg:g', { class: `node${object.id === target ? ' is_target' : ''}`, 'data-id': object.id },
      element('svg:circle', { cx: x, cy: y, r: kRadius }), element('svg:text', { x, y, text: String(object.id) }));
    node.addEventListener('click', () => choose(object.id));
    return node;
  });
  const view_box = `${-width / 2 - 8} ${-height / 2 - 8} ${width + 16} ${height + 16}`;
  const label = `The pile: ${objects.length} parts, ${edges.length > 0 ? 'some lie on others' : 'none on another'}`;
  by_id('pile').replaceChildren(element('svg:svg', { viewBox: view_box, role: 'img', 'aria-label': label },
    element('svg:rect', { class: 'bin', x: -width / 2, y: -height / 2, width, height, rx: 6 }), ...edges, ...nodes));
}

export function light(lit) {
  for (const node of by_id('pile').querySelectorAll('.node')) {
    node.classList.toggle('is_lit', lit.has(Number(node.dataset.id)));
  }
}
