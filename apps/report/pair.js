'use strict';
// The chosen pair: both images with their inliers, why it ended as it did, and its line of the ledger.

const pairView = {lines: true, blinking: null, showsMatch: false};
const inlierPixels = report.inliers ? new Uint16Array(decoded(report.inliers.pixels).buffer) : new Uint16Array(0);
const inlierBegin = [0];
if (report.inliers) for (const count of report.inliers.counts) inlierBegin.push(inlierBegin[inlierBegin.length - 1] + count);

/** Four numbers an inlier, in pixels: query x, y, match x, y. */
function inliersOf(row) {
  const list = [];
  if (!report.inliers) return list;
  for (let i = inlierBegin[row]; i < inlierBegin[row + 1]; i++) {
    list.push([0, 1, 2, 3].map((k) => inlierPixels[4 * i + k] / 8 + 0.5));
  }
  return list;
}

function jpegOf(frame) {
  return report.images && report.images.jpegs[frame] ? 'data:image/jpeg;base64,' + report.images.jpegs[frame] : null;
}

function pairPicture(row) {
  const query = ledger.query[row], match = ledger.match[row];
  if (!jpegOf(query) || !jpegOf(match)) {
    return element('div', {class: 'none', text: 'No pictures: make the report with --images FOLDER, or --truth SEQUENCE.'});
  }
  const {width, height} = report.images, between = Math.round(width * 0.012);
  const blink = pairView.blinking !== null;
  const offset = blink ? 0 : width + between;
  const svg = element('svg', {viewBox: `0 0 ${blink ? width : 2 * width + between} ${height}`, role: 'img',
                              'aria-label': `Images ${report.frames[query]} (query) and ${report.frames[match]} (match) with their inliers`});
  const image = (frame, x) => element('image', {href: jpegOf(frame), x, y: 0, width, height, preserveAspectRatio: 'none'});
  if (!blink || !pairView.showsMatch) svg.append(image(query, 0));
  if (!blink || pairView.showsMatch) svg.append(image(match, offset));
  const inliers = inliersOf(row), size = (blink ? 1 : 2) * width / 640;
  inliers.forEach(([qx, qy, mx, my], index) => {
    const hue = `hsl(${Math.round(360 * ((index * 0.618034) % 1))} 90% 60%)`;
    if (blink) {
      const [x, y] = pairView.showsMatch ? [mx, my] : [qx, qy];
      svg.append(element('circle', {cx: x, cy: y, r: 2.5 * size, fill: 'none', stroke: hue, 'stroke-width': 1.4 * size}));
      return;
    }
    if (pairView.lines) svg.append(element('line', {x1: qx, y1: qy, x2: mx + offset, y2: my, stroke: hue, 'stroke-width': 0.8 * size, 'stroke-opacity': 0.75}));
    for (const [x, y] of [[qx, qy], [mx + offset, my]]) svg.append(element('circle', {cx: x, cy: y, r: 2.2 * size, fill: 'none', stroke: hue, 'stroke-width': 1.2 * size}));
  });
  return svg;
}

/** A gate's figure in a row; second_support is a quotient of two columns. */
function figureOf(name, row) {
  if (name === 'second_support') return ledger.second_inliers ? ledger.second_inliers[row] / Math.max(1, ledger.true_inliers[row]) : null;
  if (name === 'ransac_iterations') name = 'iterations';
  return ledger[name] ? ledger[name][row] : null;
}

function passes(gate, value) {
  if (value === null || (gate.at_least === undefined && gate.at_most === undefined)) return null;
  return gate.at_least !== undefined ? value >= gate.at_least : value <= gate.at_most;
}

const limitText = (gate) => gate.at_least !== undefined ? 'at least ' + shown(gate.at_least) : gate.at_most !== undefined ? 'at most ' + shown(gate.at_most) : '';

/** The gate at which the hypothesis ended; none where no single figure decides. */
function endingGate(row) {
  const name = report.verdicts[ledger.verdict[row]].gate;
  return report.gates.find((gate) => gate.name === name);
}

function pairWords(row) {
  const verdict = ledger.verdict[row], truth = report.truth ? report.truth.rows[row] : null;
  const kind = verdict === 'Accepted' ? 'good' : verdict === 'Unconfirmed' || verdict === 'ContradictsMap' ? 'wary' : 'bad';
  const words = [element('b', {class: kind, text: verdict}), ': ' + report.verdicts[verdict].meaning + '. '];
  const gate = endingGate(row);
  if (gate) words.push(`${gate.name} is ${shown(figureOf(gate.name, row))}, ${limitText(gate)} is asked. `);
  if (verdict === 'ContradictsMap' && ledger.map_chi2) words.push(`Its squared error in the map is ${shown(ledger.map_chi2[row], 3)}. `);
  if (ledger.p_new) words.push(`The image is at a new place with probability ${shown(ledger.p_new[row], 3)}; by appearance this place has ${shown(ledger.probability[row], 3)}. `);
  if (truth) {
    const place = ['The truth: another place', 'The truth: the same place', 'The truth does not say whether it is the same place'][truth.place];
    const errors = [truth.rotation_error_deg !== undefined ? `turned wrongly by ${shown(truth.rotation_error_deg, 3)}°` : '',
                    truth.translation_error_m !== undefined ? `moved wrongly by ${shown(truth.translation_error_m, 3)} m` : '',
                    truth.direction_error_deg !== undefined ? `direction wrong by ${shown(truth.direction_error_deg, 3)}°` : ''].filter((text) => text !== '');
    words.push(place + (errors.length > 0 ? '; pose ' + errors.join(', ') : '') + '.');
  }
  return words;
}

/** The gates as they were asked; those after the one that failed were never reached. */
function ledgerTable(row) {
  const ending = endingGate(row), rows = [];
  let reached = true;
  for (const gate of report.gates) {
    const value = reached ? figureOf(gate.name, row) : null;
    const passed = passes(gate, value);
    const fails = gate === ending;
    rows.push(element('tr', {}, element('td', {text: gate.name}), element('td', {text: reached ? shown(value) : '–'}), element('td', {text: limitText(gate)}),
                      element('td', {class: fails ? 'fails' : 'ok', text: !reached ? '' : fails ? 'fails' : passed ? 'ok' : ''}), element('td', {class: 'why', text: gate.explanation})));
    if (fails) reached = false;
  }
  if (ledger.map_weight && ledger.map_weight[row] !== null) {
    rows.push(element('tr', {}, element('td', {text: 'map_weight'}), element('td', {text: shown(ledger.map_weight[row])}), element('td', {text: ''}), element('td', {text: ''}),
                      element('td', {class: 'why', text: 'how far the back end believes it: 1 is fully'})));
  }
  return element('table', {}, element('thead', {}, element('tr', {}, ...['figure', 'value', 'asked', '', 'what it is'].map((text) => element('th', {scope: 'col', text})))), element('tbody', {}, ...rows));
}

function showPair(row) {
  const query = ledger.query[row], match = ledger.match[row];
  byId('pair-title').textContent = `${query} → ${match}`;
  byId('pair-title').title = `${report.frames[query]} → ${report.frames[match]}`;
  byId('pair-picture').replaceChildren(pairPicture(row),
    element('p', {class: 'hint', text: `${report.frames[query]} (query${pairView.blinking !== null ? '' : ', left'}) and ${report.frames[match]} (match)` + (report.inliers && report.inliers.counts[row] < ledger.inliers[row] ? `; ${report.inliers.counts[row]} of ${ledger.inliers[row]} inliers drawn` : '')}));
  byId('pair-words').replaceChildren(...pairWords(row));
  byId('pair-ledger').replaceChildren(ledgerTable(row));
}

function setUpPair() {
  choice.listeners.push(showPair);
  const redraw = () => { if (choice.row >= 0) showPair(choice.row); };
  byId('show-lines').addEventListener('click', (event) => {
    pairView.lines = !pairView.lines;
    event.currentTarget.setAttribute('aria-pressed', pairView.lines);
    redraw();
  });
  byId('blink').addEventListener('click', (event) => {
    if (pairView.blinking !== null) {
      clearInterval(pairView.blinking);
      pairView.blinking = null;
    } else {
      pairView.blinking = setInterval(() => {
        pairView.showsMatch = !pairView.showsMatch;
        if (choice.row >= 0) byId('pair-picture').firstChild.replaceWith(pairPicture(choice.row));
      }, 700);
    }
    event.currentTarget.setAttribute('aria-pressed', pairView.blinking !== null);
    redraw();
  });
}
