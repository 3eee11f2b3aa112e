'use strict';
// How the pointer, the wheel and keys move the map from above, and choose a loop.

function zoomAt(factor, x, y) {
  const canvas = byId('above'), dx = x - canvas.clientWidth / 2, dy = canvas.clientHeight / 2 - y;
  scene.centre = [scene.centre[0] + dx / scene.scale * (1 - 1 / factor), scene.centre[1] + dy / scene.scale * (1 - 1 / factor)];
  scene.scale *= factor;
  scene.isMoved = true;
  redrawMap();
}

/** The shown loop nearest to a place on the screen. */
function nearestLoop(x, y) {
  let best = -1, least = 14;
  for (let row = 0; row < numRows; row++) {
    if (!loopsOn[categoryOfRow[row]]) continue;
    const p = finalFlat.get(ledger.query[row]), q = finalFlat.get(ledger.match[row]);
    if (!p || !q) continue;
    const a = toScreen(p), b = toScreen(q);
    const dx = b[0] - a[0], dy = b[1] - a[1], length = dx * dx + dy * dy;
    const t = length > 0 ? Math.max(0, Math.min(1, ((x - a[0]) * dx + (y - a[1]) * dy) / length)) : 0;
    const distance = Math.hypot(a[0] + t * dx - x, a[1] + t * dy - y);
    if (distance < least) { least = distance; best = row; }
  }
  return best;
}

function setUpPointer(canvas) {
  let from = null, moved = 0;
  canvas.addEventListener('pointerdown', (event) => { from = [event.offsetX, event.offsetY]; moved = 0; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener('pointermove', (event) => {
    if (!from) return;
    const dx = event.offsetX - from[0], dy = event.offsetY - from[1];
    moved += Math.abs(dx) + Math.abs(dy);
    scene.centre = [scene.centre[0] - dx / scene.scale, scene.centre[1] + dy / scene.scale];
    from = [event.offsetX, event.offsetY];
    if (moved >= 5) scene.isMoved = true;
    redrawMap();
  });
  canvas.addEventListener('pointerup', (event) => {
    const isClick = from && moved < 5;
    from = null;
    if (!isClick) return;
    const row = nearestLoop(event.offsetX, event.offsetY);
    if (row >= 0) choice.set(row);
  });
  canvas.addEventListener('wheel', (event) => {
    if (!event.ctrlKey && !event.shiftKey && document.activeElement !== canvas) return;
    event.preventDefault();
    zoomAt(Math.exp(-0.0015 * (event.deltaY || event.deltaX)), event.offsetX, event.offsetY);
  }, {passive: false});
  canvas.addEventListener('keydown', (event) => {
    const shift = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]}[event.key];
    if (shift) scene.centre = scene.centre.map((value, i) => value + 40 * shift[i] / scene.scale);
    else if (event.key === '+' || event.key === '=') scene.scale *= 1.25;
    else if (event.key === '-') scene.scale /= 1.25;
    else return;
    event.preventDefault();
    scene.isMoved = true;
    redrawMap();
  });
}
