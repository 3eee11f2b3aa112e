'use strict';
// Small plots, drawn as SVG with the style sheet's colours.

/** Round steps for an axis. */
function ticks(low, high, wanted = 5) {
  if (!(high > low)) return [low];
  const raw = (high - low) / wanted;
  const power = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= raw);
  const list = [];
  for (let value = Math.ceil(low / step) * step; value <= high + 1e-9 * step; value += step) list.push(value);
  return list;
}

/** Axes: `x` and `y` are {low, high, label}; gives the drawing and functions from values to pixels. */
function axes(x, y, height, title) {
  const width = 640, left = 52, right = 12, top = 10, bottom = 44;
  const px = (value) => left + (value - x.low) / (x.high - x.low || 1) * (width - left - right);
  const py = (value) => height - bottom - (value - y.low) / (y.high - y.low || 1) * (height - top - bottom);
  const svg = element('svg', {class: 'plot', viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': title});
  for (const tick of ticks(x.low, x.high)) {
    svg.append(element('line', {class: 'grid', x1: px(tick), x2: px(tick), y1: top, y2: height - bottom}));
    svg.append(element('text', {x: px(tick), y: height - bottom + 16, 'text-anchor': 'middle', text: shown(tick, 3)}));
  }
  for (const tick of ticks(y.low, y.high)) {
    svg.append(element('line', {class: 'grid', x1: left, x2: width - right, y1: py(tick), y2: py(tick)}));
    svg.append(element('text', {x: left - 7, y: py(tick) + 4, 'text-anchor': 'end', text: shown(tick, 3)}));
  }
  svg.append(element('text', {x: (left + width - right) / 2, y: height - 6, 'text-anchor': 'middle', text: x.label}));
  svg.append(element('text', {transform: `translate(13 ${(top + height - bottom) / 2}) rotate(-90)`, 'text-anchor': 'middle', text: y.label}));
  return {svg, px, py, left, right: width - right, top, bottom: height - bottom};
}

function polyline(plot, points, colourName, more = {}) {
  plot.svg.append(element('polyline', {points: points.map(([x, y]) => `${plot.px(x).toFixed(1)},${plot.py(y).toFixed(1)}`).join(' '),
                                       style: `stroke: var(--${colourName})`, ...more}));
}

function legend(entries) {
  return element('div', {class: 'legend'}, ...entries.map(([name, colourName]) =>
    element('span', {}, element('i', {style: `border-color: var(--${colourName})`}), name)));
}

/** Colours of the stages, which some runs have fewer of. */
function stageColour(stage) {
  return 'stage' + ['appearance', 'matching', 'geometry', 'consistency', 'back end'].indexOf(stage.stage);
}

function plotPrecisionRecall(stages) {
  const hasCurve = stages.some((stage) => stage.curve);
  byId('precision-recall').closest('figure').hidden = !hasCurve;
  if (!hasCurve) return;
  const plot = axes({low: 0, high: 1, label: 'recall of queries'}, {low: 0, high: 1, label: 'precision'}, 360, 'Precision against recall, a curve a stage');
  for (const stage of stages) {
    if (!stage.curve) continue;
    const points = stage.curve.recall.map((recall, i) => [recall, stage.curve.precision[i]]);
    if (points.length === 0) continue;
    polyline(plot, [[0, points[0][1]], ...points], stageColour(stage));
    const [x, y] = points[points.length - 1];
    plot.svg.append(element('circle', {cx: plot.px(x), cy: plot.py(y), r: 4, style: `fill: var(--${stageColour(stage)})`},
                            element('title', {text: `${stage.stage}: precision ${shown(y, 3)} at recall ${shown(x, 3)}`})));
  }
  const entries = stages.filter((stage) => stage.curve).map((stage) =>
    [`${stage.stage}: AP ${shown(stage.average_precision.value, 3)}`, stageColour(stage)]);
  byId('precision-recall').replaceChildren(plot.svg, legend(entries));
}

function plotReliability(stages) {
  byId('reliability').closest('figure').hidden = !ledger.probability;
  if (!ledger.probability) return;
  const plot = axes({low: 0, high: 1, label: 'claimed probability'}, {low: 0, high: 1, label: 'share that is true'}, 360, 'Claimed probability against the share that is true');
  polyline(plot, [[0, 0], [1, 1]], 'quiet', {'stroke-dasharray': '5 5'});
  const entries = [];
  for (const stage of stages) {
    if (!stage.calibration || (stage.stage !== 'appearance' && stage.stage !== 'geometry')) continue;
    const bins = stage.calibration.bins.filter((bin) => bin.count > 0);
    // A handful in a bin says nothing: such bins keep their disc, but do not bend the line.
    const many = bins.filter((bin) => bin.count >= 5);
    polyline(plot, many.map((bin) => [bin.mean_score, bin.share_true]), stageColour(stage));
    const most = Math.max(...bins.map((bin) => bin.count));
    for (const bin of bins) {
      plot.svg.append(element('circle', {cx: plot.px(bin.mean_score), cy: plot.py(bin.share_true), r: 2.5 + 7 * Math.sqrt(bin.count / most),
                                         style: `fill: var(--${stageColour(stage)}); fill-opacity: .55`},
                              element('title', {text: `${stage.stage}: ${bin.count} claimed ${shown(bin.mean_score, 3)}, ${shown(bin.share_true, 3)} were true`})));
    }
    entries.push([`${stage.stage} (${stage.score}): ECE ${shown(stage.expected_calibration_error.value, 2)}, Brier ${shown(stage.brier_score.value, 2)}, ${stage.calibration.decisions} judged`, stageColour(stage)]);
  }
  byId('reliability').replaceChildren(plot.svg, legend(entries), element('p', {class: 'hint', text: 'On the dashed line, probabilities may be taken at their word. Discs: how many there were.'}));
}

/** Bars with their figures. */
function plotErrors(errors) {
  const most = Math.max(...errors.map((error) => error.ate_m), 1e-9);
  const rows = errors.map((error) => element('tr', {},
    element('td', {text: error.name, title: error.note || ''}), element('td', {text: shown(error.ate_m, 3) + ' m'}),
    element('td', {style: 'width: 55%; text-align: left'}, element('span', {class: 'meter', style: `width: ${(100 * error.ate_m / most).toFixed(1)}%`}))));
  const notes = errors.filter((error) => error.note).map((error) => `${error.name}: ${error.note}`).join('; ');
  byId('errors').replaceChildren(element('table', {}, element('tbody', {}, ...rows)), element('p', {class: 'hint', text: notes}));
}

/** A value a frame, as thin bars. */
function plotByFrame(id, values, label, high) {
  const top = high === undefined ? Math.max(1, ...values.filter((value) => value !== null)) : high;
  const plot = axes({low: 0, high: Math.max(1, numFrames - 1), label: 'frame'}, {low: 0, high: top, label}, 230, label + ' by frame');
  let path = '';
  values.forEach((value, frame) => {
    if (value !== null && value > 0) path += `M${plot.px(frame).toFixed(1)} ${plot.bottom}V${plot.py(value).toFixed(1)}`;
  });
  plot.svg.append(element('path', {d: path, style: `stroke: var(--accent); stroke-width: ${Math.max(0.7, Math.min(4, 420 / numFrames)).toFixed(2)}`}));
  byId(id).replaceChildren(plot.svg);
}
