'use strict';
// What the map shows, and the map from above on a canvas of its own.

const tracks = [
  {key: 'reference', name: 'reference', dash: [2, 4], on: true},
  {key: 'odometry', name: 'odometry', dash: [7, 5], on: true},
  {key: 'online', name: 'as believed at the time', dash: [], on: false},
  {key: 'final', name: 'result', dash: [], on: true},
].filter((track) => report.map[track.key] && (report.live || report.map[track.key].length > 0))
 .map((track) => ({...track, positions: trackOf(report.map[track.key])}));
const finalTrack = tracks.find((track) => track.key === 'final').positions;
const loopsOn = categories.map((_, index) => index <= WITHDRAWN);
const scene = {centre: [0, 0], scale: 1, points: report.map.points, pointsOn: true, space: null, isSpace: false, isMoved: false, newest: null};

/** Axes of the view from above: x and y across the vertical, as near as may be to the world's. */
function axesAcross(up) {
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const across = (a) => { const d = dot(a, up), v = a.map((value, i) => value - d * up[i]), n = Math.hypot(...v); return v.map((value) => value / n); };
  const x = across(Math.abs(up[0]) > 0.9 ? [0, 1, 0] : [1, 0, 0]);
  const y = [up[1] * x[2] - up[2] * x[1], up[2] * x[0] - up[0] * x[2], up[0] * x[1] - up[1] * x[0]];
  return [x, y];
}
let [alongX, alongY] = axesAcross(report.map.up);
const flat = (p) => [p[0] * alongX[0] + p[1] * alongX[1] + p[2] * alongX[2], p[0] * alongY[0] + p[1] * alongY[1] + p[2] * alongY[2]];
for (const track of tracks) track.flat = new Map([...track.positions].map(([frame, position]) => [frame, flat(position)]));
const finalFlat = tracks.find((track) => track.key === 'final').flat;

/** Points as plain arrays; greys in [0, 1]. */
const mapPoints = (() => {
  if (!scene.points) return null;
  const raw = new Uint16Array(decoded(scene.points.positions).buffer), greys = decoded(scene.points.greys);
  const positions = new Float32Array(raw.length);
  for (let i = 0; i < raw.length; i++) positions[i] = scene.points.origin[i % 3] + raw[i] * scene.points.step[i % 3];
  return {positions, greys};
})();

function fitAbove() {
  const canvas = byId('above'), all = tracks.flatMap((track) => [...track.flat.values()]);
  const xs = all.map((p) => p[0]), ys = all.map((p) => p[1]);
  const range = (values) => values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
  const [x0, x1] = range(xs), [y0, y1] = range(ys);
  scene.isMoved = false;
  if (!(x1 - x0 + (y1 - y0) > 0)) {  // nothing yet, or one place
    scene.centre = all.length > 0 ? all[0] : [0, 0];
    scene.scale = 1;
    return;
  }
  scene.centre = [(x0 + x1) / 2, (y0 + y1) / 2];
  scene.scale = 0.88 * Math.min(canvas.clientWidth / Math.max(x1 - x0, 1e-6), canvas.clientHeight / Math.max(y1 - y0, 1e-6));
}

function toScreen(p) {
  const canvas = byId('above');
  return [canvas.clientWidth / 2 + (p[0] - scene.centre[0]) * scene.scale, canvas.clientHeight / 2 - (p[1] - scene.centre[1]) * scene.scale];
}

function drawPoints(context, canvas) {
  if (!mapPoints || !scene.pointsOn) return;
  const dark = document.documentElement.dataset.theme === 'dark';
  const shades = Array.from({length: 8}, (_, i) => dark ? `rgba(255,255,255,${0.06 + 0.05 * i})` : `rgba(0,0,0,${0.41 - 0.05 * i})`);
  const dot = Math.max(1, Math.min(3, scene.scale * 0.12));
  for (let shade = 0; shade < 8; shade++) {
    context.fillStyle = shades[shade];
    for (let i = 0; i < mapPoints.greys.length; i++) {
      if (mapPoints.greys[i] >> 5 !== shade) continue;
      const [x, y] = toScreen(flat([mapPoints.positions[3 * i], mapPoints.positions[3 * i + 1], mapPoints.positions[3 * i + 2]]));
      if (x >= 0 && y >= 0 && x < canvas.clientWidth && y < canvas.clientHeight) context.fillRect(x, y, dot, dot);
    }
  }
}

function drawScaleBar(context, canvas) {
  if (finalFlat.size === 0) return;
  const wanted = 110 / scene.scale, power = Math.pow(10, Math.floor(Math.log10(wanted)));
  const length = [1, 2, 5, 10].map((factor) => factor * power).filter((candidate) => candidate <= wanted * 1.01).pop() || power;
  const x = canvas.clientWidth - 16, y = canvas.clientHeight - 16;
  context.strokeStyle = context.fillStyle = colour('ink');
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(x - length * scene.scale, y);
  context.lineTo(x, y);
  context.stroke();
  context.font = '12px system-ui, sans-serif';
  context.textAlign = 'right';
  context.fillText(`${shown(length)} ${report.map.unit}`, x, y - 6);
}

function drawLoops(context) {
  for (const category of [REJECTED, MISSED, WITHDRAWN, RIGHT, FALSE]) {
    if (!loopsOn[category]) continue;
    context.beginPath();
    for (let row = 0; row < numRows; row++) {
      if (categoryOfRow[row] !== category) continue;
      const a = finalFlat.get(ledger.query[row]), b = finalFlat.get(ledger.match[row]);
      if (!a || !b) continue;
      context.moveTo(...toScreen(a));
      context.lineTo(...toScreen(b));
    }
    context.strokeStyle = colour(categories[category].colour);
    context.globalAlpha = category === FALSE ? 1 : category === REJECTED ? 0.25 : numRows > 2000 ? 0.35 : 0.6;
    context.lineWidth = category === FALSE ? 2.2 : 1;
    context.stroke();
    context.globalAlpha = 1;
  }
}

function drawChoice(context) {
  if (choice.row < 0) return;
  const ends = [ledger.query[choice.row], ledger.match[choice.row]].map((frame) => finalFlat.get(frame));
  if (!ends[0] || !ends[1]) return;
  const [a, b] = ends.map(toScreen);
  for (const [style, width] of [[colour('paper'), 6], [colour(categories[categoryOfRow[choice.row]].colour), 3]]) {
    context.strokeStyle = style;
    context.lineWidth = width;
    context.beginPath();
    context.moveTo(...a);
    context.lineTo(...b);
    context.stroke();
  }
  context.fillStyle = colour('ink');
  for (const [x, y] of [a, b]) {
    context.beginPath();
    context.arc(x, y, 5, 0, 2 * Math.PI);
    context.fill();
  }
}

/** Frames that have their places before their neighbours have, which no line shows. */
function drawFrames(context) {
  if (!tracks.find((track) => track.key === 'final').on) return;
  context.fillStyle = colour('final');
  for (const position of finalFlat.values()) {
    const [x, y] = toScreen(position);
    context.fillRect(x - 2, y - 2, 4, 4);
  }
}

/** Where a run that goes on is now. */
function drawNewest(context) {
  const place = scene.newest === null ? null : finalFlat.get(scene.newest);
  if (!place) return;
  const [x, y] = toScreen(place);
  for (const [style, radius] of [[colour('paper'), 8], [colour('final'), 6]]) {
    context.fillStyle = style;
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fill();
  }
}

function drawAbove() {
  const canvas = byId('above'), ratio = window.devicePixelRatio || 1;
  if (canvas.clientWidth === 0) return;
  canvas.width = Math.round(canvas.clientWidth * ratio);
  canvas.height = Math.round(canvas.clientHeight * ratio);
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  drawPoints(context, canvas);
  drawLoops(context);
  for (const track of tracks) {
    if (!track.on) continue;
    context.strokeStyle = colour(track.key);
    context.lineWidth = track.key === 'final' ? 2.4 : 1.6;
    context.setLineDash(track.dash);
    context.beginPath();
    let previous = null;
    for (const [frame, position] of track.flat) {
      const [x, y] = toScreen(position);
      // Frames without a pose leave a gap; while a map grows, those that are yet to come.
      if (previous !== null && frame - previous <= (report.live ? 1 : 20)) context.lineTo(x, y); else context.moveTo(x, y);
      previous = frame;
    }
    context.stroke();
    context.setLineDash([]);
  }
  if (report.live) drawFrames(context);
  drawChoice(context);
  drawNewest(context);
  drawScaleBar(context, canvas);
}

let isDrawPending = false;
/** Draws once, however often it is asked for before the next frame. */
function redrawMap() {
  if (isDrawPending) return;
  isDrawPending = true;
  requestAnimationFrame(() => {
    isDrawPending = false;
    if (scene.isSpace) drawSpace(); else drawAbove();
  });
}
