'use strict';
// The run's data, and what every part of the page asks of it.

const report = JSON.parse(document.getElementById('data').textContent);
const ledger = report.ledger;
let numRows = ledger.query.length;  // of a live page it grows
const numFrames = report.frames.length;

/** What became of a hypothesis, in the order of interest: its colour is the style sheet's variable of that name. */
const categories = [
  {key: 'right', name: report.truth ? 'accepted' : 'accepted', colour: 'right'},
  {key: 'false', name: 'accepted, but false', colour: 'false'},
  {key: 'withdrawn', name: 'proved, then held back or withdrawn', colour: 'withdrawn'},
  {key: 'missed', name: 'refused, though the place is true', colour: 'missed'},
  {key: 'rejected', name: 'refused', colour: 'rejected'},
];
const [RIGHT, FALSE, WITHDRAWN, MISSED, REJECTED] = [0, 1, 2, 3, 4];
const FALSE_TRUTH = 0, TRUE_TRUTH = 1;

function categoryOf(row) {
  const truth = report.truth ? report.truth.rows[row] : null;
  const verdict = ledger.verdict[row];
  if (verdict === 'Accepted') return truth && truth.closure === FALSE_TRUTH ? FALSE : RIGHT;
  if (verdict === 'Unconfirmed' || verdict === 'ContradictsMap') return WITHDRAWN;
  return truth && truth.place === TRUE_TRUTH ? MISSED : REJECTED;
}
const categoryOfRow = Array.from({length: numRows}, (_, row) => categoryOf(row));
const numOfCategory = categories.map((_, index) => categoryOfRow.filter((category) => category === index).length);

/** The colour of a style-sheet variable, as it is now. */
function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
}

function decoded(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

/** A number as people read it: four digits, no more. */
function shown(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  if (Number.isInteger(value)) return String(value);
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 1e7)) return value.toExponential(2);
  return String(Number(value.toPrecision(digits)));
}

/** An element with attributes (`text` is its text, functions are listeners) and children. */
function element(name, attributes = {}, ...children) {
  const svg = ['svg', 'g', 'line', 'path', 'polyline', 'text', 'circle', 'rect', 'image', 'title'].includes(name);
  const node = svg ? document.createElementNS('http://www.w3.org/2000/svg', name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === 'text') node.textContent = value;
    else if (typeof value === 'function') node.addEventListener(key, value);
    else if (value !== null && value !== undefined) node.setAttribute(key, value);
  }
  node.append(...children);
  return node;
}

const byId = (id) => document.getElementById(id);

/** Which row is chosen. Everything that shows a choice listens. */
const choice = {
  row: -1,
  listeners: [],
  set(row) {
    this.row = row;
    for (const listener of this.listeners) listener(row);
  },
};

/** Positions by frame of a track of the map: a Map from frame to [x, y, z]. */
function trackOf(numbers) {
  const positions = new Map();
  for (let i = 0; numbers && i + 3 < numbers.length; i += 4) positions.set(numbers[i], numbers.slice(i + 1, i + 4));
  return positions;
}
