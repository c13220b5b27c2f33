// Poses as the protocol has them, and the pinhole camera with OpenCV's distortion.

// Row by row: [r00 r01 r02 tx, r10 …]. A scalar that is 0 may be missing.
export function matrix_of(pose) {
  const { x = 0, y = 0, z = 0 } = pose.translation_m;
  const { w = 0, x: i = 0, y: j = 0, z: k = 0 } = pose.rotation;
  return [
    1 - 2 * (j * j + k * k), 2 * (i * j - k * w), 2 * (i * k + j * w), x,
    2 * (i * j + k * w), 1 - 2 * (i * i + k * k), 2 * (j * k - i * w), y,
    2 * (i * k - j * w), 2 * (j * k + i * w), 1 - 2 * (i * i + j * j), z,
  ];
}

export const transform = (T, [x, y, z]) => [
  T[0] * x + T[1] * y + T[2] * z + T[3],
  T[4] * x + T[5] * y + T[6] * z + T[7],
  T[8] * x + T[9] * y + T[10] * z + T[11],
];

export function inverse(T) {
  const [a, b, c, x, d, e, f, y, g, h, i, z] = T;
  return [a, d, g, -(a * x + d * y + g * z), b, e, h, -(b * x + e * y + h * z), c, f, i, -(c * x + f * y + i * z)];
}

function distort([k1, k2, p1, p2, k3], x, y) {
  const r2 = x * x + y * y;
  const radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return [
    x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
    y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
  ];
}

export function project(camera, [x, y, z]) {
  const [u, v] = distort(camera.distortion, x / z, y / z);
  return [u * camera.fx_px + camera.cx_px, v * camera.fy_px + camera.cy_px];
}

let rays = null;
let rays_of = '';
// x and y at z = 1 of each pixel; computed once per camera.
export function rays_through(camera) {
  const key = JSON.stringify(camera);
  if (key === rays_of) return rays;
  const { width_px, height_px, fx_px, fy_px, cx_px, cy_px, distortion } = camera;
  const is_rectified = distortion.every((k) => k === 0);
  rays = new Float32Array(2 * width_px * height_px);
  for (let v = 0, at = 0; v < height_px; ++v) {
    for (let u = 0; u < width_px; ++u) {
      const x0 = (u - cx_px) / fx_px;
      const y0 = (v - cy_px) / fy_px;
      let [x, y] = [x0, y0];
      for (let i = 0; i < (is_rectified ? 0 : 8); ++i) {
        const [dx, dy] = distort(distortion, x, y);
        x += x0 - dx;
        y += y0 - dy;
      }
      rays[at++] = x;
      rays[at++] = y;
    }
  }
  rays_of = key;
  return rays;
}

// The frame that things are shown in: the bin's, or what its place takes.
export function shown_frame(request) {
  if (request.bin) return matrix_of(request.bin.T_base_bin);
  if (request.crop_box) return matrix_of(request.crop_box.T_base_box);
  return [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];
}
