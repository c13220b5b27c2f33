// The depth image, near yellow and far blue (cividis: the same for every eye), with outlines and grasps.
import { by_id } from './dom.js';
import { inverse, matrix_of, project, transform } from './geometry.js';

const canvas = by_id('depth');
const context = canvas.getContext('2d');
const kStops = [[0, 34, 78], [18, 53, 112], [59, 73, 108], [87, 93, 109], [112, 113, 115], [138, 134, 120],
  [165, 156, 116], [195, 179, 105], [225, 204, 85], [253, 231, 55]];
const table = new Uint32Array(256);
for (let i = 0; i < 256; ++i) {
  const at = (i / 255) * (kStops.length - 1);
  const low = Math.min(kStops.length - 2, Math.floor(at));
  const [r, g, b] = kStops[low].map((value, k) => value + (at - low) * (kStops[low + 1][k] - value));
  table[i] = (255 << 24) | (b << 16) | (g << 8) | r;
}
let image = null;
let pixels = null;
let is_whole = false;
let pixel = 1;  // of the canvas, in pixels of the image
const whole = document.createElement('canvas');

// The image's part with the bin in it: columns and rows from … to.
function part_with_bin({ camera, request }, T_camera_base) {
  const all = [0, 0, camera.width_px, camera.height_px];
  if (is_whole || !request.bin) return all;
  const { x, y, z } = request.bin.inner_size_m;
  const T = matrix_of(request.bin.T_base_bin);
  const [u, v] = [[], []];
  for (const corner of [[1, 1, 0], [1, -1, 0], [-1, 1, 0], [-1, -1, 0], [1, 1, 2], [1, -1, 2], [-1, 1, 2], [-1, -1, 2]]) {
    const p_bin_m = [(corner[0] * x) / 2, (corner[1] * y) / 2, (corner[2] * z) / 2];
    const p_camera_m = transform(T_camera_base, transform(T, p_bin_m));
    if (p_camera_m[2] <= 0) return all;
    const [column, row] = project(camera, p_camera_m);
    u.push(column);
    v.push(row);
  }
  const margin = 12;
  const within = (value, most) => Math.max(0, Math.min(most, Math.round(value)));
  const part = [within(Math.min(...u) - margin, all[2]), within(Math.min(...v) - margin, all[3]),
    within(Math.max(...u) + margin, all[2]), within(Math.max(...v) + margin, all[3])];
  return part[2] - part[0] > 8 && part[3] - part[1] > 8 ? part : all;
}

// Between the nearest and farthest hundredth of a sample.
function range_of(depth, width, [left, top, right, bottom]) {
  const sample = [];
  for (let row = top; row < bottom; row += 3) {
    for (let column = left; column < right; column += 3) {
      const value = depth[row * width + column];
      if (value > 0) sample.push(value);
    }
  }
  sample.sort((a, b) => a - b);
  if (sample.length === 0) return [0, 1];
  return [sample[Math.floor(sample.length * 0.01)], sample[Math.floor(sample.length * 0.99)]];
}

// Enlarged as a whole number of times, so that every pixel is as large as the others.
function draw_depth({ camera, depth, depth_scale_m }, part) {
  const [left, top, right, bottom] = part;
  const enlarged = Math.max(1, Math.floor(640 / (right - left)));
  const [width, height] = [(right - left) * enlarged, (bottom - top) * enlarged];
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  if (image?.width !== camera.width_px || image.height !== camera.height_px) {
    image = context.createImageData(camera.width_px, camera.height_px);
    pixels = new Uint32Array(image.data.buffer);
    whole.width = camera.width_px;
    whole.height = camera.height_px;
  }
  const [near, far] = range_of(depth, camera.width_px, part);
  const scale = 255 / Math.max(1, far - near);
  for (let i = 0; i < depth.length; ++i) {
    const value = depth[i];
    pixels[i] = value === 0 ? 0xff000000 : table[Math.max(0, Math.min(255, Math.round((far - value) * scale)))];
  }
  whole.getContext('2d').putImageData(image, 0, 0);
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.imageSmoothingEnabled = false;
  context.drawImage(whole, left, top, right - left, bottom - top, 0, 0, width, height);
  context.setTransform(enlarged, 0, 0, enlarged, -(left - 0.5) * enlarged, -(top - 0.5) * enlarged);
  pixel = 1 / enlarged;
  const metres = (value) => (value * depth_scale_m).toFixed(2);
  by_id('depth_range').textContent = `${metres(near)} to ${metres(far)} m`;
}

function draw_outlines(objects, lit) {
  for (const object of objects) {
    const outline = object.outline_px ?? [];
    context.beginPath();
    for (let i = 0; i < outline.length; i += 2) context.lineTo(outline[i], outline[i + 1]);
    context.closePath();
    context.lineWidth = (lit.has(object.id) ? 4 : 1.6) * pixel;
    context.strokeStyle = lit.has(object.id) ? '#e69f00' : '#ffffffcc';
    context.stroke();
  }
}

// From above: both jaws, and the line between them.
function draw_grasp(flight, T_camera_base, grasp, colour, is_selected) {
  const T = matrix_of(grasp.grasp.T_base_grasp);
  const half_m = Math.max(0.01, grasp.grasp.opening_width_m / 2);
  const jaw_m = (flight.request.gripper.jaw_size_m?.y ?? 0.016) / 2;
  const line = (...points) => {
    context.beginPath();
    for (const point of points) {
      const p_camera_m = transform(T_camera_base, transform(T, point));
      if (p_camera_m[2] > 0) context.lineTo(...project(flight.camera, p_camera_m));
    }
    context.stroke();
  };
  for (const [width, style] of is_selected ? [[9, '#000000'], [5, colour]] : [[2, colour]]) {
    context.lineWidth = width * pixel;
    context.strokeStyle = style;
    line([-half_m, 0, 0], [half_m, 0, 0]);
    for (const side of [-half_m, half_m]) line([side, -jaw_m, 0], [side, jaw_m, 0]);
  }
}

export function show(flight, grasps, selected, lit) {
  const T_camera_base = inverse(matrix_of(flight.request.T_base_camera));
  draw_depth(flight, part_with_bin(flight, T_camera_base));
  draw_outlines(flight.answer?.objects ?? [], lit);
  const colours = { free: '#56b4e9', colliding: '#ff8a3d', unreachable: '#f0e442' };
  for (const grasp of grasps) {
    if (grasp !== selected) draw_grasp(flight, T_camera_base, grasp, colours[grasp.kind], false);
  }
  if (selected) draw_grasp(flight, T_camera_base, selected, colours[selected.kind], true);
}

export function start(redraw) {
  by_id('whole').addEventListener('click', (event) => {
    is_whole = !is_whole;
    event.target.setAttribute('aria-pressed', is_whole);
    redraw();
  });
}
