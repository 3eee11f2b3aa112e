'use strict';
// The table of hypotheses: filtered, sorted, and only as many rows in the document as can be seen.

const tableColumns = [
  {key: 'query', name: 'query', value: (row) => ledger.query[row]},
  {key: 'match', name: 'match', value: (row) => ledger.match[row]},
  {key: 'verdict', name: 'verdict', text: true, value: (row) => ledger.verdict[row]},
  {key: 'rank', name: 'rank', value: (row) => ledger.rank ? ledger.rank[row] : null},
  {key: 'probability', name: 'appearance', value: (row) => ledger.probability ? ledger.probability[row] : null},
  {key: 'p_true', name: 'p true', value: (row) => ledger.p_true ? ledger.p_true[row] : null},
  {key: 'matches', name: 'matches', value: (row) => ledger.matches[row]},
  {key: 'inliers', name: 'inliers', value: (row) => ledger.inliers[row]},
  {key: 'weight', name: 'weight', value: (row) => ledger.map_weight ? ledger.map_weight[row] : null},
];
const rowHeight = 28;
const table = {rows: [], sort: 'query', ascending: true, first: -1, last: -1};

function passesFilters(row) {
  const text = byId('filter-frame').value.trim().toLowerCase();
  const category = byId('filter-category').value, verdict = byId('filter-verdict').value;
  if (category !== '' && categoryOfRow[row] !== Number(category)) return false;
  if (verdict !== '' && ledger.verdict[row] !== verdict) return false;
  if (ledger.probability && ledger.probability[row] < Number(byId('filter-probability').value)) return false;
  if (text === '') return true;
  const frames = [ledger.query[row], ledger.match[row]];
  if (/^\d+$/.test(text)) return frames.includes(Number(text));
  return frames.some((frame) => (report.frames[frame] || '').toLowerCase().includes(text));
}

function updateTable() {
  const column = tableColumns.find((candidate) => candidate.key === table.sort);
  const rows = [];
  for (let row = 0; row < numRows; row++) if (passesFilters(row)) rows.push(row);
  const sign = table.ascending ? 1 : -1;
  rows.sort((a, b) => {
    const x = column.value(a), y = column.value(b);
    if (x === y) return a - b;
    if (x === null) return 1;
    if (y === null) return -1;
    return (x < y ? -1 : 1) * sign;
  });
  table.rows = rows;
  table.first = -1;
  byId('count').textContent = `${rows.length} of ${numRows} hypotheses`;
  for (const head of byId('scroller').querySelectorAll('th')) {
    const sorted = head.dataset.key === table.sort;
    if (sorted) head.setAttribute('aria-sort', table.ascending ? 'ascending' : 'descending');
    else head.removeAttribute('aria-sort');
    head.querySelector('.arrow').textContent = sorted ? (table.ascending ? ' ▲' : ' ▼') : '';
  }
  drawRows();
}

function tableRow(row, position) {
  const cells = tableColumns.map((column) => {
    const value = column.value(row);
    const cell = element('td', {class: column.text ? 'text' : null});
    if (column.key === 'verdict') {
      const category = categories[categoryOfRow[row]];
      cell.append(element('span', {class: 'dot-mark', style: `background: var(--${category.colour})`, title: category.name}), value);
    } else {
      cell.textContent = shown(value, 3);
    }
    return cell;
  });
  return element('tr', {'aria-rowindex': position + 2, 'aria-selected': row === choice.row, click: () => choice.set(row)}, ...cells);
}

function gap(height) {
  return element('tr', {class: 'gap', 'aria-hidden': 'true'}, element('td', {colspan: tableColumns.length, style: `height: ${height}px; padding: 0`}));
}

function drawRows() {
  const scroller = byId('scroller'), spare = 8;
  const first = Math.max(0, Math.floor(scroller.scrollTop / rowHeight) - spare);
  const last = Math.min(table.rows.length, Math.ceil((scroller.scrollTop + scroller.clientHeight) / rowHeight) + spare);
  if (first === table.first && last === table.last) return;
  table.first = first;
  table.last = last;
  const body = scroller.querySelector('tbody');
  const rows = [];
  if (first > 0) rows.push(gap(first * rowHeight));
  for (let position = first; position < last; position++) rows.push(tableRow(table.rows[position], position));
  if (last < table.rows.length) rows.push(gap((table.rows.length - last) * rowHeight));
  if (table.rows.length === 0) rows.push(element('tr', {class: 'gap'}, element('td', {colspan: tableColumns.length, text: 'No hypothesis is like that.'})));
  body.replaceChildren(...rows);
  scroller.querySelector('table').setAttribute('aria-rowcount', table.rows.length + 1);
}

/** The row so many places further, and into view with it. */
function step(distance) {
  if (table.rows.length === 0) return;
  const now = table.rows.indexOf(choice.row);
  const next = Math.max(0, Math.min(table.rows.length - 1, now < 0 ? 0 : now + distance));
  choice.set(table.rows[next]);
}

function scrollToChoice() {
  const position = table.rows.indexOf(choice.row), scroller = byId('scroller');
  if (position < 0) return;
  const top = position * rowHeight, head = 40;
  if (top < scroller.scrollTop) scroller.scrollTop = top;
  if (top + rowHeight + head > scroller.scrollTop + scroller.clientHeight) scroller.scrollTop = top + rowHeight + head - scroller.clientHeight;
}

function setUpTable() {
  const head = element('tr', {});
  for (const column of tableColumns) {
    const sort = () => {
      table.ascending = table.sort === column.key ? !table.ascending : column.key === 'query' || column.key === 'match' || column.key === 'verdict' || column.key === 'rank';
      table.sort = column.key;
      byId('scroller').scrollTop = 0;
      updateTable();
    };
    head.append(element('th', {scope: 'col', 'data-key': column.key, class: column.text ? 'text' : null},
                        element('button', {type: 'button', click: sort}, column.name, element('span', {class: 'arrow', 'aria-hidden': 'true'}))));
  }
  const scroller = byId('scroller');
  scroller.querySelector('thead').append(head);
  scroller.addEventListener('scroll', drawRows, {passive: true});
  scroller.addEventListener('keydown', (event) => {
    if (event.target !== scroller) return;
    const distance = {ArrowDown: 1, ArrowUp: -1, PageDown: 15, PageUp: -15, Home: -numRows, End: numRows}[event.key];
    if (distance === undefined) return;
    event.preventDefault();
    step(distance);
  });
  byId('filter-category').append(element('option', {value: '', text: `any (${numRows})`}),
    ...categories.map((category, index) => element('option', {value: index, text: `${category.name} (${numOfCategory[index]})`})));
  const verdicts = [...new Set(ledger.verdict)].sort();
  byId('filter-verdict').append(element('option', {value: '', text: 'any'}), ...verdicts.map((verdict) => element('option', {value: verdict, text: verdict})));
  const filtered = () => { scroller.scrollTop = 0; updateTable(); };
  for (const id of ['filter-frame', 'filter-category', 'filter-verdict', 'filter-probability']) byId(id).addEventListener('input', filtered);
  byId('filter-reset').addEventListener('click', () => {
    byId('filter-frame').value = '';
    byId('filter-category').value = '';
    byId('filter-verdict').value = '';
    byId('filter-probability').value = 0;
    filtered();
  });
  byId('previous').addEventListener('click', () => step(-1));
  byId('next').addEventListener('click', () => step(1));
  choice.listeners.push(() => { table.first = -1; scrollToChoice(); drawRows(); });
  updateTable();
}
