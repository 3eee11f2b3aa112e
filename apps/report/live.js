'use strict';
// The page while its run goes on: it asks the program that serves it what is new, once a second, and its map grows.

const live = {since: 0, world: null, failures: 0, timer: null, stage: '', page: Math.random().toString(36).slice(2)};

/** Of a run without a map the page has the stages alone. */
const isProgressAlone = report.live && report.live.shows === 'progress';

const reportPath = report.live ? `${report.live.folder.replace(/\/$/, '')}/report.html` : '';

/** What the stages are to people, where their names do not say it. */
const stageNames = {
  features: 'Finding features', 'k-means': 'Learning visual words', mapping: 'Mapping', pairs: 'Comparing pairs of images', placing: 'Placing images',
  adjust: 'Adjusting everything', camera: 'Checking the camera', georeference: 'Fitting known positions', result: 'Gathering the result',
  'without loops': 'The same without loops, to compare with', report: 'Making the report', cells: 'Running cells',
};
const stageName = (stage) => stageNames[stage.name] || stage.name.charAt(0).toUpperCase() + stage.name.slice(1);

function duration(seconds) {
  const whole = Math.round(seconds), rest = whole % 60, minutes = Math.floor(whole / 60) % 60, hours = Math.floor(whole / 3600);
  if (whole < 60) return `${whole} s`;
  return hours > 0 ? `${hours} h ${String(minutes).padStart(2, '0')} min` : `${minutes} min ${String(rest).padStart(2, '0')} s`;
}

/** New places of frames. Tracks are drawn in the order of frames, in which they need not come. */
function putPositions(key, numbers) {
  const track = tracks.find((candidate) => candidate.key === key);
  const frames = [...track.positions.keys()];
  let last = frames.length > 0 ? frames[frames.length - 1] : -1, isInOrder = true;
  for (let i = 0; i + 3 < numbers.length; i += 4) {
    const frame = numbers[i];
    if (!track.positions.has(frame)) {
      if (frame < last) isInOrder = false; else last = frame;
    }
    track.positions.set(frame, numbers.slice(i + 1, i + 4));
  }
  if (!isInOrder) {
    const sorted = [...track.positions].sort(([a], [b]) => a - b);
    track.positions.clear();
    for (const [frame, position] of sorted) track.positions.set(frame, position);
  }
  track.flat.clear();
  for (const [frame, position] of track.positions) track.flat.set(frame, flat(position));
}

function putLoops(numbers) {
  for (let i = 0; i + 4 < numbers.length; i += 5) {
    const [row, query, match, verdict, inliers] = numbers.slice(i, i + 5);
    ledger.query[row] = query;
    ledger.match[row] = match;
    ledger.verdict[row] = report.live.verdicts[verdict];
    ledger.inliers[row] = inliers;
    if (categoryOfRow[row] !== undefined) numOfCategory[categoryOfRow[row]]--;
    categoryOfRow[row] = categoryOf(row);
    numOfCategory[categoryOfRow[row]]++;
  }
  numRows = ledger.query.length;
  for (const label of byId('layers').querySelectorAll('[data-category]')) {
    const index = Number(label.dataset.category);
    label.lastChild.textContent = `${categories[index].name} (${numOfCategory[index]})`;
  }
}

function putMap(news) {
  if (live.world !== news.world) for (const track of tracks) track.positions.clear();
  live.world = news.world;
  report.map.unit = news.unit;
  report.map.up = news.up;
  [alongX, alongY] = axesAcross(news.up);
  putPositions('final', news.placed);
  putPositions('odometry', news.odometry);
  putLoops(news.loops);
  for (const label of byId('layers').querySelectorAll('[data-track]')) {
    label.hidden = tracks.find((track) => track.key === label.dataset.track).positions.size === 0;
  }
  scene.newest = news.state === 'running' ? news.newest : null;
  byId('map-empty').hidden = finalTrack.size > 0;
  if (scene.space) fillSpace();
  if (!scene.isMoved) {
    if (scene.isSpace) fitSpace(); else fitAbove();
  }
  redrawMap();
}

function showStages(news) {
  const done = [...news.stages], stage = news.state === 'running' ? done.pop() : null;
  byId('live-stages').replaceChildren(...done.map((one) => element('li', {text: `${stageName(one)}, ${duration(one.seconds)}`})));
  for (const part of [byId('live-bar'), byId('live-stage').parentNode]) part.hidden = !stage;
  if (!stage) return;
  const bar = byId('live-bar'), isKnown = stage.total > 0, share = isKnown ? Math.min(1, stage.done / stage.total) : 0;
  byId('live-stage').textContent = stageName(stage);
  byId('live-done').textContent = isKnown ? `${stage.done} of ${stage.total}` : '';
  const rate = stage.seconds > 0.5 ? stage.done / stage.seconds : 0;
  const left = rate > 0 && share < 1 ? `, about ${duration((stage.total - stage.done) / rate)} left in this stage` : '';
  byId('live-pace').textContent = (rate > 0 ? `${shown(rate, 2)}/s` : '') + (rate > 0 ? left : '');
  bar.firstElementChild.style.width = isKnown ? `${(100 * share).toFixed(1)}%` : '';
  const attributes = isKnown ? {'aria-valuemax': stage.total, 'aria-valuenow': stage.done, 'aria-valuetext': `${stage.done} of ${stage.total}`} : {};
  for (const name of ['aria-valuemax', 'aria-valuenow', 'aria-valuetext']) {
    if (name in attributes) bar.setAttribute(name, attributes[name]); else bar.removeAttribute(name);
  }
  document.title = `${isKnown ? Math.floor(100 * share) + ' % ' : ''}${stageName(stage)} · ${summary.sequence}`;
  byId('map-empty').textContent = `Nothing is placed yet: ${stageName(stage).toLowerCase()}.`;
}

function showCounts(news) {
  const {placed, hypotheses, accepted, held_back: heldBack} = news.counts;
  if (isProgressAlone) {
    byId('verdict').textContent = news.state === 'running' ? `Under way for ${duration(news.elapsed_s)}.` : `It took ${duration(news.elapsed_s)}.`;
    return;
  }
  const soFar = news.state === 'running' ? ' so far' : '';
  byId('verdict').replaceChildren(...(placed === 0 ? ['The run has begun; its map comes later.']
    : [element('b', {text: `${accepted} ${accepted === 1 ? 'loop' : 'loops'}`}), `${soFar}, over ${placed} ${placed === 1 ? 'image' : 'images'} placed.`]));
  byId('cards').replaceChildren(card('Images placed', String(placed), ''), card('Hypotheses', String(hypotheses), ''), card('Loops', String(accepted), 'accepted'),
    card('Held back', String(heldBack), 'proved, but not believed'), card('Elapsed', duration(news.elapsed_s), ''));
}

function tell(kind, ...words) {
  byId('note').className = kind;
  byId('note').hidden = words.length === 0;
  byId('note').replaceChildren(...words);
}

const code = (text) => element('code', {text});

/** The run has ended: its report takes this page's place. It comes as a whole, since the program ends too. */
async function becomeReport() {
  tell('good', 'The run has ended. Its report is ', code(reportPath), '.');
  try {
    const answer = await fetch(`/report.html?page=${live.page}`);
    if (!answer.ok) return;
    const body = element('body', {'data-was-live': reportPath}).outerHTML.replace('</body>', '');
    const page = (await answer.text()).replace('<body>', () => body);
    location.replace(URL.createObjectURL(new Blob([page], {type: 'text/html'})));
  } catch (error) {
    // The program has gone; the page stays as it is, and says where the report is.
  }
}

/** Of a report that has taken a live page's place. */
function tellWhereItIsKept() {
  tell('good', 'The run has ended. This is its report, kept in ', code(document.body.dataset.wasLive), '.');
}

function showEnd(news) {
  document.title = `${news.state === 'ended' ? 'ended' : 'stopped'} · ${summary.sequence}`;
  if (news.state === 'failed') tell('bad', `The run has stopped: ${news.why}`);
  else if (isProgressAlone) tell('good', 'The run has ended. Its files are in ', code(report.live.folder), '.');
  else if (news.has_report) return becomeReport();
  else tell('good', 'The run has ended, without a report, as it was asked to. Its files are in ', code(report.live.folder), '; ', code(`fabloop report ${report.live.folder}`), ' makes one.');
  return null;
}

async function latestNews() {
  try {
    const answer = await fetch(`/live.json?since=${live.since}&page=${live.page}`, {cache: 'no-store'});
    return answer.ok ? await answer.json() : null;
  } catch (error) {
    return null;
  }
}

async function ask() {
  live.timer = null;
  const news = await latestNews();
  if (news && news.run !== report.live.run) return location.reload();  // another run on the same port
  if (!news && ++live.failures === 3) {
    const result = isProgressAlone ? ['its files are in ', code(report.live.folder)] : ['its report is ', code(reportPath)];
    tell('wary', 'The run no longer answers: it has ended or was stopped. If it has ended, ', ...result, '. What follows is what was last seen of it.');
    byId('live-pace').textContent = '';
  }
  if (news) {
    if (live.failures >= 3) tell('');
    live.failures = 0;
    live.since = news.since;
    putMap(news);
    showStages(news);
    showCounts(news);
    document.documentElement.dataset.live = news.state;
    if (news.state !== 'running' && !news.more) return showEnd(news);
  }
  live.timer = setTimeout(ask, news && news.more ? 0 : live.failures < 3 ? 1000 : 5000);
  return null;
}

function setUpLive() {
  byId('title').textContent = summary.sequence;
  byId('live').hidden = false;
  for (const id of ['loops', 'recognition', 'stages', 'cost', 'details']) byId(id).hidden = true;
  for (const part of document.querySelectorAll('nav, .skip')) part.hidden = true;
  document.querySelector('footer').textContent = 'Served by the run itself, to this machine alone, for as long as it goes on; it shows what has been found so far, which later images may still change.';
  byId('verdict').textContent = isProgressAlone ? 'The run has begun.' : 'The run has begun; its map comes later.';
  if (isProgressAlone) {
    for (const id of ['map', 'cards']) byId(id).hidden = true;
    document.querySelector('footer').textContent = 'Served by the run itself, to this machine alone, for as long as it goes on.';
  }
  byId('map-empty').hidden = false;
  setUpMap();
  setUpTheme();
  choice.listeners.push((row) => {
    if (row >= 0) byId('map-hint').textContent = `Loop ${ledger.query[row]} → ${ledger.match[row]}: ${ledger.verdict[row]}, ${ledger.inliers[row]} inliers.`;
  });
  // Pages in the background are put to sleep.
  document.addEventListener('visibilitychange', () => {
    if (document.hidden || live.timer === null) return;
    clearTimeout(live.timer);
    ask();
  });
  ask();
  document.documentElement.dataset.ready = 'yes';
}
