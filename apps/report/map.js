'use strict';
// The map's two views, and the switches of its layers.

function showView(isSpace) {
  byId('space').hidden = !isSpace;
  byId('above').hidden = isSpace;
  if (isSpace && !scene.space) {
    try {
      setUpSpace();
    } catch (error) {
      showView(false);
      byId('map-hint').textContent = 'This browser has no WebGL, which the 3-D view needs.';
      byId('view-space').disabled = true;
      return;
    }
  }
  scene.isSpace = isSpace;
  byId('view-above').setAttribute('aria-pressed', !isSpace);
  byId('view-space').setAttribute('aria-pressed', isSpace);
  byId('map-hint').textContent = isSpace ? 'Drag to turn, scroll to zoom, right-drag to move.' : 'Drag to move, Shift and scroll to zoom, click a loop to see ' + (report.live ? 'what it is.' : 'its images.');
  if (isSpace) fillSpace();
  redrawMap();
}

function layerSwitch(name, swatch, isOn, change) {
  const box = element('input', {type: 'checkbox', change: (event) => { change(event.target.checked); if (scene.space) fillSpace(); redrawMap(); }});
  box.checked = isOn;
  return element('label', {}, box, ...(swatch ? [swatch] : []), name);
}

/** Shows as much of the map as before, whatever its size on the screen. */
function keepExtent() {
  const {clientWidth, clientHeight} = byId('map-frame');
  if (clientWidth === 0) return;
  if (scene.size) scene.scale *= Math.min(clientWidth / scene.size[0], clientHeight / scene.size[1]);
  scene.size = [clientWidth, clientHeight];
  redrawMap();
}

function setUpMap() {
  for (const track of tracks) {
    const swatch = element('span', {class: 'swatch' + (track.dash.length > 0 ? ' dashed' : ''), style: `color: var(--${track.key})`});
    const label = layerSwitch(track.name, swatch, track.on, (on) => { track.on = on; });
    label.dataset.track = track.key;
    byId('layers').append(label);
  }
  categories.forEach((category, index) => {
    const mayCome = report.live && index !== FALSE && index !== MISSED;  // those two are for who knows the truth
    if (numOfCategory[index] === 0 && !mayCome) return;
    const swatch = element('span', {class: 'swatch', style: `color: var(--${category.colour})`});
    const label = layerSwitch(`${category.name} (${numOfCategory[index]})`, swatch, loopsOn[index], (on) => { loopsOn[index] = on; });
    label.dataset.category = index;
    byId('layers').append(label);
  });
  if (mapPoints) byId('layers').append(layerSwitch('points', null, scene.pointsOn, (on) => { scene.pointsOn = on; }));
  setUpPointer(byId('above'));
  byId('view-above').addEventListener('click', () => showView(false));
  byId('view-space').addEventListener('click', () => showView(true));
  if (typeof THREE === 'undefined') {
    byId('view-space').disabled = true;
    byId('view-space').title = 'The program was built without three.js (libjs-three).';
  }
  byId('view-reset').addEventListener('click', () => { if (scene.isSpace) fitSpace(); else fitAbove(); redrawMap(); });
  new ResizeObserver(keepExtent).observe(byId('map-frame'));
  choice.listeners.push(() => { if (scene.space && scene.isSpace) fillSpace(); redrawMap(); });
  fitAbove();
  showView(false);
}
