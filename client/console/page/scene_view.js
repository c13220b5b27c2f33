// The bin in three dimensions. Drawn when something changed, not all the time.
import * as THREE from './three/three.module.js';
import { OrbitControls } from './three/OrbitControls.js';
import { by_id, css_colour } from './dom.js';
import { get_triangles } from './feed.js';
import { inverse, matrix_of, rays_through, shown_frame } from './geometry.js';

const canvas = by_id('scene');
const kMostParts_n = 256;
const kWallReach_m = 0.006; // readings so near a wall are the wall's, which is drawn already
const kCloudVertex = `
uniform float size;
varying float height;
void main() {
  height = position.z;
  vec4 p = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * p;
  gl_PointSize = clamp(size / -p.z, 1.0, 6.0);
}`;
const kCloudFragment = `
uniform vec3 low;
uniform vec3 high;
uniform float top;
varying float height;
void main() { gl_FragColor = vec4(mix(low, high, clamp(height / top, 0.0, 1.0)), 1.0); }`;

const matrix4 = (T) => new THREE.Matrix4().set(...T, 0, 0, 0, 1);

export function make_scene() {
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(38, 1, 0.02, 20);
  camera.up.set(0, 0, 1);
  const controls = new OrbitControls(camera, canvas);
  const sun = new THREE.DirectionalLight(0xffffff, 2.2);
  sun.position.set(0.4, -0.6, 1.2);
  scene.add(new THREE.HemisphereLight(0xffffff, 0x556070, 1.6), sun);

  const cloud_material = new THREE.ShaderMaterial({
    vertexShader: kCloudVertex, fragmentShader: kCloudFragment,
    uniforms: { size: { value: 2 }, low: { value: new THREE.Color() }, high: { value: new THREE.Color() }, top: { value: 0.1 } },
  });
  const cloud = new THREE.Points(new THREE.BufferGeometry(), cloud_material);
  cloud.frustumCulled = false;
  const parts = new THREE.Group();
  const fixed = new THREE.Group();
  const grasps = new THREE.Group();
  scene.add(cloud, parts, fixed, grasps);

  const materials = {};
  const colours = {};
  const shapes = new Map();
  let frame_key = '';
  let is_asked = false;
  let last = null;

  function draw() {
    is_asked = false;
    renderer.render(scene, camera);
    if (parts.children.length > 0) canvas.dataset.drawn = '';
  }
  function invalidate() {
    if (is_asked) return;
    is_asked = true;
    requestAnimationFrame(draw);
  }

  function take_colours() {
    for (const name of ['free', 'colliding', 'unreachable', 'quiet', 'accent', 'near', 'line', 'ink']) {
      colours[name] = new THREE.Color(css_colour(`--${name}`));
    }
    const is_dark = colours.ink.r > 0.5;
    cloud_material.uniforms.low.value.set(is_dark ? 0x2e3c4c : 0xc6cfd8);
    cloud_material.uniforms.high.value.set(is_dark ? 0x9fb2c4 : 0x8796a5);
    materials.part = new THREE.MeshStandardMaterial({ color: is_dark ? 0x8fa3b5 : 0x7f95a8, roughness: 0.65, metalness: 0.1 });
    materials.target = new THREE.MeshStandardMaterial({ color: colours.accent, roughness: 0.55 });
    materials.lit = new THREE.MeshStandardMaterial({ color: colours.near, roughness: 0.55 });
  }

  // Meshes come once; until then the parts are left out.
  function shape_of(id) {
    if (!shapes.has(id)) {
      shapes.set(id, null);
      get_triangles(id).then((triangles) => {
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute('position', new THREE.BufferAttribute(triangles, 3));
        geometry.computeVertexNormals();
        shapes.set(id, geometry);
        if (last) show(...last);
      }).catch((error) => console.info(error.message));
    }
    return shapes.get(id);
  }

  // What is not in the bin is left out: it would hide what matters.
  function show_cloud(flight, T_shown_camera) {
    const { x: long_m, y: wide_m } = flight.request.bin?.inner_size_m ?? { x: Infinity, y: Infinity };
    const [most_x, most_y] = [long_m / 2 - kWallReach_m, wide_m / 2 - kWallReach_m];
    const { depth, depth_scale_m } = flight;
    const rays = rays_through(flight.camera);
    let positions = cloud.geometry.getAttribute('position');
    if (!positions || positions.count !== depth.length) {
      cloud.geometry.dispose();
      cloud.geometry = new THREE.BufferGeometry();
      positions = new THREE.BufferAttribute(new Float32Array(3 * depth.length), 3).setUsage(THREE.DynamicDrawUsage);
      cloud.geometry.setAttribute('position', positions);
    }
    const T = T_shown_camera;
    const out = positions.array;
    let n = 0;
    for (let i = 0; i < depth.length; ++i) {
      const z = depth[i] * depth_scale_m;
      if (z === 0) continue;
      const x = rays[2 * i] * z;
      const y = rays[2 * i + 1] * z;
      const shown_x = T[0] * x + T[1] * y + T[2] * z + T[3];
      const shown_y = T[4] * x + T[5] * y + T[6] * z + T[7];
      if (Math.abs(shown_x) > most_x || Math.abs(shown_y) > most_y) continue;
      out[n++] = shown_x;
      out[n++] = shown_y;
      out[n++] = T[8] * x + T[9] * y + T[10] * z + T[11];
    }
    cloud.geometry.setDrawRange(0, n / 3);
    positions.needsUpdate = true;
  }

  function show_parts(objects, target, lit) {
    const shown = objects.slice(0, kMostParts_n).filter((object) => shape_of(object.part_id));
    while (parts.children.length > shown.length) parts.remove(parts.children.at(-1));
    shown.forEach((object, i) => {
      if (!parts.children[i]) parts.add(Object.assign(new THREE.Mesh(), { matrixAutoUpdate: false }));
      const mesh = parts.children[i];
      mesh.geometry = shape_of(object.part_id);
      mesh.material = lit.has(object.id) ? materials.lit : object.id === target ? materials.target : materials.part;
      mesh.matrix.copy(matrix4(matrix_of(object.T_base_part)));
      mesh.matrixWorldNeedsUpdate = true;
    });
  }

  function clear(group) {
    for (const child of group.children) {
      child.geometry?.dispose();
      child.material?.dispose?.();
    }
    group.clear();
  }
  function lines(points, colour, dashed) {
    const geometry = new THREE.BufferGeometry().setFromPoints(points);
    const material = dashed ? new THREE.LineDashedMaterial({ color: colour, dashSize: 0.008, gapSize: 0.005 })
                            : new THREE.LineBasicMaterial({ color: colour });
    return new THREE.LineSegments(geometry, material).computeLineDistances();
  }
  const point = (x, y, z) => new THREE.Vector3(x, y, z);

  function show_bin(request, T_shown_base) {
    clear(fixed);
    if (!request.bin) return;
    const { x, y, z } = request.bin.inner_size_m;
    const wall = request.bin.wall_thickness_m ?? 0;
    const T = matrix4(T_shown_base).multiply(matrix4(matrix_of(request.bin.T_base_bin)));
    for (const grown of wall > 0 ? [0, 2 * wall] : [0]) {
      const edges = new THREE.EdgesGeometry(new THREE.BoxGeometry(x + grown, y + grown, z));
      const box = new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color: colours.quiet }));
      box.applyMatrix4(T.clone().multiply(new THREE.Matrix4().makeTranslation(0, 0, z / 2)));
      fixed.add(box);
    }
  }

  // Two jaws and what joins them, as lines.
  function fork(grasp, gripper, colour) {
    const half = Math.max(0.008, grasp.opening_width_m / 2);
    const up = -Math.min(0.045, gripper.jaw_size_m.z);
    return lines([point(-half, 0, 0), point(-half, 0, up), point(half, 0, 0), point(half, 0, up),
      point(-half, 0, up), point(half, 0, up), point(0, 0, up), point(0, 0, up - 0.02)], colour);
  }
  function solid_gripper(grasp, gripper, colour) {
    const body = new THREE.Group();
    const material = () => new THREE.MeshStandardMaterial({ color: colour, transparent: true, opacity: 0.72, roughness: 0.5 });
    const box = (size, x, z) => {
      const mesh = new THREE.Mesh(new THREE.BoxGeometry(size.x, size.y, size.z), material());
      mesh.position.set(x, 0, z);
      body.add(mesh);
    };
    if (gripper.kind === 'SUCTION') {
      const radius = Math.max(0.004, (gripper.cup_diameter_m ?? 0.02) / 2);
      const cup = new THREE.Mesh(new THREE.CylinderGeometry(radius * 0.6, radius, 0.03, 24), material());
      cup.rotation.x = -Math.PI / 2;
      cup.position.z = -0.015;
      body.add(cup);
    } else {
      const jaw = gripper.jaw_size_m;
      const offset = (grasp.opening_width_m + jaw.x) / 2;
      box(jaw, -offset, -jaw.z / 2);
      box(jaw, offset, -jaw.z / 2);
      box(gripper.palm_size_m, 0, -jaw.z - gripper.palm_size_m.z / 2);
    }
    const start = -(grasp.standoff_m ?? 0.08);
    body.add(lines([point(0, 0, start), point(0, 0, 0)], colours.ink, true),
      lines([point(0, 0, 0), point(0.006, 0, -0.012), point(0, 0, 0), point(-0.006, 0, -0.012)], colours.ink));
    return body;
  }
  function show_grasps(all, selected, gripper, T_shown_base) {
    grasps.traverse((child) => {
      child.geometry?.dispose();
      child.material?.dispose?.();
    });
    grasps.clear();
    for (const entry of all) {
      const make = entry === selected ? solid_gripper : fork;
      const made = make(entry.grasp, gripper, colours[entry.kind]);
      made.applyMatrix4(matrix4(T_shown_base).multiply(matrix4(matrix_of(entry.grasp.T_base_grasp))));
      grasps.add(made);
    }
  }

  function look_from(view) {
    const from = { tilted: [0.12, -0.46, 0.44], top: [0, -0.001, 0.66], side: [0, -0.68, 0.1] }[view];
    const reach = Math.max(0.2, ...(last ? [last[0].request.bin?.inner_size_m.x ?? 0.3] : [0.3])) / 0.3;
    // A tall canvas sees less to its sides.
    const far = reach * Math.max(1, 1.25 / camera.aspect);
    controls.target.set(0, 0, 0.055);
    camera.position.set(from[0] * far, from[1] * far, from[2] * far + 0.055);
    controls.update();
    invalidate();
  }

  function show(flight, all, selected, target, lit) {
    last = [flight, all, selected, target, lit];
    const T_shown_base = inverse(shown_frame(flight.request));
    parts.matrixAutoUpdate = false;
    parts.matrix.copy(matrix4(T_shown_base));
    parts.matrixWorldNeedsUpdate = true;
    if (flight.name !== cloud.flight) {
      const T = matrix4(T_shown_base).multiply(matrix4(matrix_of(flight.request.T_base_camera))).transpose().elements;
      show_cloud(flight, T);
      cloud.flight = flight.name;
      cloud_material.uniforms.top.value = flight.request.bin?.inner_size_m.z ?? 0.1;
      show_bin(flight.request, T_shown_base);
    }
    show_parts(flight.answer?.objects ?? [], target, lit);
    show_grasps(all, selected, flight.request.gripper, T_shown_base);
    const key = flight.cell + JSON.stringify(flight.request.bin ?? null);
    if (key !== frame_key) {
      frame_key = key;
      look_from('tilted');
    }
    invalidate();
  }

  function resize() {
    const { clientWidth: width, clientHeight: height } = canvas.parentElement;
    if (width === 0 || height === 0) return;
    renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    cloud_material.uniforms.size.value = height * Math.min(2, devicePixelRatio) * 0.0026;
    invalidate();
  }

  function turn(event) {
    const step = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    const offset = camera.position.clone().sub(controls.target);
    const angles = new THREE.Spherical().setFromVector3(point(offset.x, offset.z, -offset.y));
    angles.theta += step[0];
    angles.phi = Math.max(0.01, Math.min(Math.PI / 2, angles.phi + step[1]));
    const turned = new THREE.Vector3().setFromSpherical(angles);
    camera.position.copy(controls.target).add(point(turned.x, -turned.z, turned.y));
    controls.update();
    invalidate();
  }

  controls.addEventListener('change', invalidate);
  canvas.addEventListener('keydown', turn);
  new ResizeObserver(resize).observe(canvas.parentElement);
  take_colours();
  resize();
  return {
    show,
    look_from,
    toggle(what, on) {
      ({ cloud, parts })[what].visible = on;
      invalidate();
    },
    recolour() {
      take_colours();
      cloud.flight = null;
      if (last) show(...last);
    },
  };
}
