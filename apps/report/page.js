'use strict';
// Puts the page together.

const summary = report.summary;

/** The run in one sentence. */
function verdictWords() {
  const accepted = summary.loops.accepted, errors = report.truth ? report.truth.errors : [];
  const find = (name) => errors.find((error) => error.name === name);
  const before = find('odometry'), after = find('final');
  const words = [element('b', {text: `${accepted} ${accepted === 1 ? 'loop' : 'loops'} closed`}), ` over ${summary.frames.mapped} of ${summary.frames.images} images`];
  if (report.truth) {
    const judged = report.truth.evaluation.stages[report.truth.evaluation.stages.length - 1].passed;
    const checked = judged.true + judged.false;
    words.push(', ', judged.false === 0
      ? element('span', {class: 'good', text: checked === 0 ? 'none of them judged by the truth' : `none of ${checked} judged is false`})
      : element('span', {class: 'bad', text: `${judged.false} of ${checked} judged are false`}));
  } else {
    words.push(', not judged: no truth was given');
  }
  if (before && after) {
    const less = before.ate_m / after.ate_m;
    words.push('. The trajectory is off by ', element('b', {text: `${shown(after.ate_m, 3)} m`}), ` instead of ${shown(before.ate_m, 3)} m`,
      element('span', {class: less >= 1 ? 'good' : 'bad', text: less >= 1 ? `, ${shown(less, 2)} times less` : ', which is worse'}));
  }
  words.push('.');
  return words;
}

const percent = (share) => `${shown(100 * share, 3)} %`;

function card(name, value, note) {
  return element('div', {}, element('dt', {text: name}), element('dd', {}, value, element('small', {text: note})));
}

function cards() {
  const timings = Object.values(summary.timings || {}), total = timings.reduce((sum, stage) => sum + stage.total_s, 0);
  const list = [card('Images', String(summary.frames.mapped), summary.frames.mapped === summary.frames.images ? 'all mapped' : `of ${summary.frames.images}`),
                card('Hypotheses', String(numRows), `${shown(numRows / Math.max(1, summary.frames.mapped), 3)} an image`),
                card('Loops', String(summary.loops.accepted), `${summary.loops.accepted_with_scale} with scale`)];
  if (report.truth) {
    const last = report.truth.evaluation.stages[report.truth.evaluation.stages.length - 1];
    list.push(card('False loops', String(last.passed.false), `${last.passed.true} true, ${last.passed.unjudged} not judged`));
    if (last.query_recall) list.push(card('Recall of queries', percent(last.query_recall.value), last.query_recall.low === undefined ? '' : `${percent(last.query_recall.low)} to ${percent(last.query_recall.high)}`));
  }
  list.push(card('Time an image', `${shown(1000 * total / Math.max(1, summary.frames.images), 3)} ms`, `${shown(total, 3)} s of work`));
  if (summary.peak_memory_mib) list.push(card('Memory', `${shown(summary.peak_memory_mib, 3)} MiB`, 'at most'));
  byId('cards').append(...list);
}

function figureCell(figure) {
  if (!figure) return element('td', {text: '–'});
  const cell = element('td', {text: shown(figure.value, 3)});
  if (figure.low !== undefined) cell.append(element('small', {text: `${shown(figure.low, 2)}–${shown(figure.high, 2)}`}));
  return cell;
}

function stageTable(evaluation) {
  const figures = [['precision', 'precision'], ['query_recall', 'query recall'], ['false_rejection', 'false refused'], ['average_precision', 'average precision'],
                   ['recall_at_full_precision', 'recall at 100 %'], ['expected_calibration_error', 'ECE'], ['brier_score', 'Brier']]
    .filter(([key]) => evaluation.stages.some((stage) => stage[key]));  // some runs have nothing to sort by
  const ks = Object.keys(evaluation.stages[0].recall_at);
  const head = ['stage', 'true', 'false', 'not judged', ...figures.map(([, title]) => title), ...ks.map((k) => 'recall@' + k)];
  const rows = evaluation.stages.map((stage) => element('tr', {}, element('td', {text: stage.stage}), ...['true', 'false', 'unjudged'].map((key) => element('td', {text: stage.passed[key]})),
    ...figures.map(([key]) => figureCell(stage[key])), ...ks.map((k) => element('td', {text: shown(stage.recall_at[k], 3)}))));
  byId('stage-table').replaceChildren(element('caption', {class: 'unseen', text: 'What each stage lets through'}),
    element('thead', {}, element('tr', {}, ...head.map((text) => element('th', {scope: 'col', text})))), element('tbody', {}, ...rows));
}

function costTables() {
  const stages = Object.entries(summary.timings || {}), most = Math.max(...stages.map(([, stage]) => stage.total_s), 1e-9);
  const rows = stages.map(([name, stage]) => element('tr', {}, element('td', {text: name}), element('td', {text: stage.count}),
    ...['p50_ms', 'p99_ms', 'max_ms'].map((key) => element('td', {text: shown(stage[key], 3)})), element('td', {text: shown(stage.total_s, 3)}),
    element('td', {style: 'width: 30%; text-align: left'}, element('span', {class: 'meter', style: `width: ${(100 * stage.total_s / most).toFixed(1)}%`}))));
  byId('times').replaceChildren(element('caption', {class: 'unseen', text: 'Time by stage'}),
    element('thead', {}, element('tr', {}, ...['stage', 'times', 'p50 ms', 'p99 ms', 'max ms', 'total s', ''].map((text) => element('th', {scope: 'col', text})))), element('tbody', {}, ...rows));
  const kept = Object.entries(summary.memory || {});
  const memory = kept.map(([name, mib]) => element('tr', {}, element('td', {text: name.replace('_mib', '')}), element('td', {text: shown(mib, 3) + ' MiB'}), element('td', {text: shown(1024 * mib / Math.max(1, summary.frames.mapped), 3) + ' KiB'})));
  byId('memory').replaceChildren(element('caption', {class: 'unseen', text: 'Memory kept in the end'}),
    element('thead', {}, element('tr', {}, ...['kept in the end', 'all', 'an image'].map((text) => element('th', {scope: 'col', text})))), element('tbody', {}, ...memory));
}

/** Nested settings as "a.b" lines. */
function flatSettings(settings, prefix = '') {
  return Object.entries(settings).flatMap(([key, value]) =>
    value !== null && typeof value === 'object' && !Array.isArray(value) ? flatSettings(value, `${prefix}${key}.`) : [[prefix + key, value]]);
}

function settingsBlock(title, settings, isOpen) {
  const rows = flatSettings(settings).map(([key, value]) => element('tr', {}, element('td', {text: key}), element('td', {text: typeof value === 'number' ? shown(value, 6) : String(value)})));
  return element('details', isOpen ? {open: ''} : {}, element('summary', {text: title}), element('table', {}, element('tbody', {}, ...rows)));
}

function details() {
  const left = element('div', {}, settingsBlock('Versions', summary.versions || {}, true), settingsBlock('Model', summary.model || {}, true), settingsBlock('Graph', summary.graph || {}, true));
  const right = element('div', {});
  for (const [name, settings] of Object.entries(summary.parameters || {})) right.append(settingsBlock(`Parameters: ${name.replace('_', ' ')}`, settings, name === 'verifier'));
  right.append(settingsBlock('Verdicts', summary.loops.verdicts || {}, false));
  byId('parameters').append(left, right);
}

function drawMatrix() {
  const canvas = byId('matrix'), ratio = window.devicePixelRatio || 1, size = canvas.clientWidth;
  if (size === 0) return;
  canvas.width = canvas.height = Math.round(size * ratio);
  const context = canvas.getContext('2d'), cell = canvas.width / numFrames, dot = Math.max(cell, 1.6 * ratio);
  const byCategory = !ledger.probability || byId('matrix-colour').value === 'category';
  context.strokeStyle = colour('line');
  context.beginPath();
  context.moveTo(0, 0);
  context.lineTo(canvas.width, canvas.height);
  context.stroke();
  const order = Array.from({length: numRows}, (_, row) => row).sort((a, b) => byCategory ? categoryOfRow[b] - categoryOfRow[a] : ledger.probability[a] - ledger.probability[b]);
  const colours = categories.map((category) => colour(category.colour)), ink = colour('ink');
  for (const row of order) {
    context.globalAlpha = byCategory ? 1 : 0.06 + 0.94 * Math.sqrt(ledger.probability[row]);
    context.fillStyle = byCategory ? colours[categoryOfRow[row]] : ink;
    context.fillRect(ledger.match[row] * cell, ledger.query[row] * cell, dot, dot);
  }
  context.globalAlpha = 1;
  if (choice.row < 0) return;
  context.strokeStyle = colour('accent');
  context.lineWidth = 2 * ratio;
  context.beginPath();
  context.arc((ledger.match[choice.row] + 0.5) * cell, (ledger.query[choice.row] + 0.5) * cell, 7 * ratio, 0, 2 * Math.PI);
  context.stroke();
}

function setUpRecognition() {
  const canvas = byId('matrix');
  canvas.addEventListener('click', (event) => {
    const scale = numFrames / canvas.clientWidth, query = event.offsetY * scale, match = event.offsetX * scale;
    let best = -1, least = 12 * scale;
    for (let row = 0; row < numRows; row++) {
      const distance = Math.hypot(ledger.query[row] + 0.5 - query, ledger.match[row] + 0.5 - match);
      if (distance < least) { least = distance; best = row; }
    }
    if (best >= 0) choice.set(best);
  });
  canvas.addEventListener('keydown', (event) => {
    const distance = {ArrowDown: 1, ArrowUp: -1, ArrowRight: 1, ArrowLeft: -1}[event.key];
    if (distance === undefined) return;
    event.preventDefault();
    step(distance);
  });
  byId('matrix-colour').addEventListener('change', drawMatrix);
  if (!ledger.probability) {  // of a run whose pairs are proposed without a belief
    for (const id of ['matrix-colour', 'filter-probability']) byId(id).closest('label').hidden = true;
  }
  byId('matrix-note').textContent = `Queries downwards, places across: the most probable places of each query (${numRows} pairs). The stronger, the more probable; the arrow keys walk through the table's rows.`;
  choice.listeners.push(drawMatrix);
  new ResizeObserver(drawMatrix).observe(canvas);
  const pNew = new Array(numFrames).fill(null), inliers = new Array(numFrames).fill(null);
  for (let row = 0; row < numRows; row++) {
    const frame = ledger.query[row];
    if (ledger.p_new) pNew[frame] = ledger.p_new[row];
    inliers[frame] = Math.max(inliers[frame] || 0, ledger.inliers[row]);
  }
  if (ledger.p_new) {
    plotByFrame('new-place', pNew, 'p(new place)', 1);
  } else {
    for (const part of document.querySelectorAll('[data-belief]')) part.hidden = true;
    byId('matrix-note').textContent = `Queries downwards, matches across: the pairs beyond neighbours that two views prove (${numRows}). The arrow keys walk through the table's rows.`;
  }
  plotByFrame('inlier-plot', inliers, 'inliers');
}

function setUpTheme() {
  const choices = ['system', 'light', 'dark'], system = window.matchMedia('(prefers-color-scheme: dark)');
  let chosen = 'system';
  const apply = () => {
    const dark = chosen === 'dark' || (chosen === 'system' && system.matches);
    document.documentElement.dataset.theme = dark ? 'dark' : 'light';
    byId('theme').textContent = `Theme: ${chosen}`;
    if (scene.space) fillSpace();
    redrawMap();
    drawMatrix();
  };
  byId('theme').addEventListener('click', () => {
    chosen = choices[(choices.indexOf(chosen) + 1) % choices.length];
    apply();
  });
  system.addEventListener('change', apply);
  // Paper is white.
  let before = null;
  window.addEventListener('beforeprint', () => { before = document.documentElement.dataset.theme; document.documentElement.dataset.theme = 'light'; drawAbove(); drawMatrix(); });
  window.addEventListener('afterprint', () => { if (before) document.documentElement.dataset.theme = before; redrawMap(); drawMatrix(); });
  apply();
}

/** The row to begin with: a false loop if there is one, else the accepted one that leads furthest back. */
function firstChoice() {
  const wanted = categoryOfRow.includes(FALSE) ? FALSE : RIGHT;
  let best = numRows > 0 ? 0 : -1, furthest = -1;
  for (let row = 0; row < numRows; row++) {
    const distance = Math.abs(ledger.query[row] - ledger.match[row]);
    if (categoryOfRow[row] === wanted && distance > furthest) { furthest = distance; best = row; }
  }
  return best;
}

function setUpPage() {
  byId('title').textContent = summary.sequence || 'run';
  byId('verdict').append(...verdictWords());
  cards();
  setUpMap();
  setUpPair();
  setUpTable();
  setUpRecognition();
  if (report.truth) {
    const {evaluation, errors} = report.truth;
    stageTable(evaluation);
    plotPrecisionRecall(evaluation.stages);
    plotReliability(evaluation.stages);
    plotErrors(errors);
    byId('recipe').textContent = evaluation.recipe;
  } else {
    for (const part of document.querySelectorAll('[data-truth]')) part.hidden = true;
  }
  costTables();
  details();
  setUpTheme();
  const row = firstChoice();
  if (row >= 0) choice.set(row);
  if (document.body.dataset.wasLive) tellWhereItIsKept();
  document.documentElement.dataset.ready = 'yes';
}

if (report.live) setUpLive(); else setUpPage();
