'use strict';
// The map in 3-D, by three.js.

/** A line of the 3-D view through positions. */
function spaceLine(positions, colourName, opacity, isPairs) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(positions), 3));
  const material = new THREE.LineBasicMaterial({color: colour(colourName), transparent: true, opacity});
  return isPairs ? new THREE.LineSegments(geometry, material) : new THREE.Line(geometry, material);
}

function fillSpace() {
  const world = scene.space.world;
  while (world.children.length > 0) {
    const child = world.children.pop();
    child.geometry.dispose();
    child.material.dispose();
  }
  for (const track of tracks) if (track.on) world.add(spaceLine([...track.positions.values()].flat(), track.key, 1, false));
  categories.forEach((category, index) => {
    if (!loopsOn[index]) return;
    const ends = [];
    for (let row = 0; row < numRows; row++) {
      if (categoryOfRow[row] !== index) continue;
      const a = finalTrack.get(ledger.query[row]), b = finalTrack.get(ledger.match[row]);
      if (a && b) ends.push(...a, ...b);
    }
    if (ends.length > 0) world.add(spaceLine(ends, category.colour, index === FALSE ? 1 : 0.4, true));
  });
  if (choice.row >= 0) {
    const ends = [ledger.query[choice.row], ledger.match[choice.row]].map((frame) => finalTrack.get(frame));
    if (ends[0] && ends[1]) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(ends.flat()), 3));
      world.add(new THREE.Points(geometry, new THREE.PointsMaterial({color: colour('ink'), size: 9, sizeAttenuation: false})));
      world.add(spaceLine(ends.flat(), 'ink', 1, true));
    }
  }
  if (mapPoints && scene.pointsOn) {
    const geometry = new THREE.BufferGeometry(), greys = new Float32Array(mapPoints.greys.length * 3);
    for (let i = 0; i < greys.length; i++) greys[i] = mapPoints.greys[Math.floor(i / 3)] / 255;
    geometry.setAttribute('position', new THREE.BufferAttribute(mapPoints.positions, 3));
    geometry.setAttribute('color', new THREE.BufferAttribute(greys, 3));
    world.add(new THREE.Points(geometry, new THREE.PointsMaterial({size: 1.6, sizeAttenuation: false, vertexColors: THREE.VertexColors})));
  }
}

function fitSpace() {
  if (finalTrack.size === 0) return;
  const all = [...finalTrack.values()], range = (axis) => all.reduce(([low, high], p) => [Math.min(low, p[axis]), Math.max(high, p[axis])], [Infinity, -Infinity]);
  const ranges = [0, 1, 2].map(range), centre = ranges.map(([low, high]) => (low + high) / 2);
  const size = Math.max(1e-3, Math.hypot(...ranges.map(([low, high]) => high - low)));
  scene.isMoved = false;
  const {camera, controls} = scene.space, up = new THREE.Vector3(...report.map.up);
  camera.near = size / 1000;
  camera.far = size * 50;
  camera.up.copy(up);
  camera.position.set(...centre).addScaledVector(up, 0.62 * size).addScaledVector(new THREE.Vector3(...alongY), -0.72 * size);
  camera.updateProjectionMatrix();
  controls.target.set(...centre);
  controls.update();
}

function setUpSpace() {
  const box = byId('space'), renderer = new THREE.WebGLRenderer({antialias: true, alpha: true, preserveDrawingBuffer: true});
  const camera = new THREE.PerspectiveCamera(45, 1, 0.1, 1000), world = new THREE.Scene();
  camera.up.set(...report.map.up);
  renderer.setPixelRatio(window.devicePixelRatio || 1);
  renderer.domElement.setAttribute('role', 'img');
  renderer.domElement.setAttribute('aria-label', 'Map in three dimensions: drag to turn, scroll to zoom, right-drag to move.');
  box.append(renderer.domElement);
  const controls = new THREE.OrbitControls(camera, renderer.domElement);
  controls.addEventListener('change', redrawMap);
  controls.addEventListener('start', () => { scene.isMoved = true; });
  scene.space = {renderer, camera, world, controls};
  fillSpace();
  fitSpace();
}

function drawSpace() {
  const {renderer, camera, world} = scene.space, box = byId('space');
  renderer.setSize(box.clientWidth, box.clientHeight);
  camera.aspect = box.clientWidth / Math.max(1, box.clientHeight);
  camera.updateProjectionMatrix();
  renderer.render(world, camera);
}
