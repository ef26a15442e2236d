// The page of a database: scatter, filters, parallel coordinates, table, and the board of a point.
import {h} from './dom.js';
import {count, fixed, value, whole} from './format.js';
import {addChart, htmlTable} from './chart.js';
import {textBox} from './chart_config.js';
import {addParallel} from './chart_parallel.js';
import {addScatter} from './chart_scatter.js';
import {addAnswers, addGroup, addHead} from './page_parts.js';
import {Points} from './points.js';
import {Boards} from './table.js';

const kMostChips = 16;
const kRowsShown = 100;

// Filters: the values of each key that varies, to be switched off and on.
function addFilters(page, points) {
  const off = new Map();
  const shown = points.keys.filter(key => new Set(points.column(key)).size <= kMostChips);
  if (points.table.has('status') && !points.table.isConstant('status')) shown.unshift('status');
  const groups = shown.map(key => {
    const values = points.column(key);
    const words = [...new Set(values)].sort((a, b) => typeof a === 'number' ? a - b : value(a).localeCompare(value(b)));
    off.set(key, new Set());
    return h('fieldset', null, h('legend', null, key), words.map(word => h('label', {class: 'chip'},
        h('input', {type: 'checkbox', checked: true, 'data-key': key, 'data-value': value(word), change: event => {
          if (event.target.checked) off.get(key).delete(word);
          else off.get(key).add(word);
          points.filter(`chips ${key}`, off.get(key).size > 0 ? row => !off.get(key).has(values[row]) : null);
        }}), ` ${value(word)}`)));
  });
  const reset = h('button', {type: 'button', class: 'small', id: 'reset-filters', click: () => {
    for (const box of groups.flatMap(group => [...group.querySelectorAll('input')])) box.checked = true;
    for (const set of off.values()) set.clear();
    for (const name of [...points.filters.keys()]) points.filters.delete(name);
    points.filter('', null);
  }}, 'Select all points');
  addChart(page, {id: 'filters', wide: true, title: 'Filters', body: [h('div', {class: 'filters'}, groups), reset]});
}

// The table of the selected points, sorted by one column.
function addTable(page, points, first, choose) {
  const names = [...first, ...points.keys, ...points.figures.filter(name => !first.includes(name)).slice(0, 4)];
  const state = {by: first[0], down: true};
  const host = h('div');
  const rowsInOrder = () => {
    const values = points.column(state.by);
    const rows = [];
    for (let row = 0; row < points.size; ++row) if (points.selected[row]) rows.push(row);
    const sign = state.down ? -1 : 1;
    return rows.sort((a, b) => {
      const [x, y] = [values[a], values[b]];
      if (x === null || y === null) return (x === null) - (y === null);
      return sign * (typeof x === 'number' && typeof y === 'number' ? x - y : value(x).localeCompare(value(y)));
    });
  };
  const show = () => {
    const rows = rowsInOrder();
    const table = htmlTable(['', ...names], rows.slice(0, kRowsShown).map(row => [
      h('button', {type: 'button', class: 'small', 'data-row': row, click: () => choose(row)}, 'Board'),
      ...names.map(name => points.column(name)[row])]));
    table.querySelectorAll('th').forEach((cell, i) => {
      if (i === 0) return;
      const name = names[i - 1];
      cell.setAttribute('aria-sort', state.by === name ? (state.down ? 'descending' : 'ascending') : 'none');
      cell.replaceChildren(h('button', {type: 'button', class: 'sort', click: () => {
        state.down = state.by === name ? !state.down : true;
        state.by = name;
        show();
      }}, `${name}${state.by === name ? (state.down ? ' ↓' : ' ↑') : ''}`));
    });
    host.replaceChildren(table, h('p', {class: 'note'}, rows.length > kRowsShown ? `The first ${kRowsShown} of ${whole(rows.length)} points; the CSV has all.` : `${count(rows.length, 'point')}.`));
  };
  points.whenSelected(final => final && show());
  show();
  addChart(page, {id: 'points', wide: true, title: 'The selected points', body: host, note: 'Click a column to sort by it.', numbers: () => {
    const all = points.table.names.filter(name => !points.table.isConstant(name));
    return [all, rowsInOrder().map(row => all.map(name => points.column(name)[row]))];
  }});
}

export function showDatabase(page, {database}) {
  const points = new Points(database);
  const boards = new Boards(database.boards, points.size);
  const rateName = points.figures.find(name => name.startsWith('frames_per_second')) ?? points.figures[0];
  const rates = points.column(rateName);
  let best = 0;
  for (let row = 1; row < points.size; ++row) if (!(rates[row] <= rates[best])) best = row;
  const keysOf = row => points.keys.map(key => `${key} ${value(points.column(key)[row])}`).join(', ');
  const statuses = points.table.has('status') ? points.column('status') : [];
  const bad = statuses.filter(status => status !== 'ok').length;
  addHead(page, {kind: 'database', name: database.path,
    headline: `${count(points.size, 'point')}: at most ${fixed(rates[best], 2)} ${rateName.startsWith('frames') ? 'frames/s' : rateName}`,
    sub: h('p', {class: 'note'}, `${points.keys.length} keys vary${bad ? `; ${whole(bad)} points are impossible or have failed` : ''}.`)});
  const limited = points.figures.find(name => name.endsWith('limited_by'));
  const tally = new Map();
  if (limited) for (const name of points.column(limited)) tally.set(name, (tally.get(name) ?? 0) + 1);
  addAnswers(page, [
    ['Which is the fastest?', [`${fixed(rates[best], 2)} frames/s: ${keysOf(best)}.`]],
    ['What limits?', limited ? [[...tally].filter(([name]) => name !== null).sort((a, b) => b[1] - a[1]).slice(0, 4).map(([name, all]) => `${name} in ${whole(all)}`).join(', ') + ' points.'] : []],
    ['What is the same in all?', [`${points.constantKeys.length} keys, such as ${points.constantKeys.filter(key => key.startsWith('matcher') || key.startsWith('image')).slice(0, 3)
      .map(key => `${key} ${value(points.column(key)[0])}`).join(', ')}.`]],
    ['What is left out?', [`${whole(database.left_out.length)} columns, most of them counters of banks and ports: the database has them.`]]].filter(([, texts]) => texts.length));

  const cards = addGroup(page, 'Points');
  const board = h('div', {id: 'board'}, h('p', {class: 'note'}, 'Click a point, or a line of the table.'));
  const choose = row => {
    points.chosen = row;
    scatter.redraw();
    const text = boards.text(row);
    board.replaceChildren(textBox(text, `point_${row}.yaml`), h('details', null, h('summary', null, 'All figures'),
        htmlTable(['column', 'value'], points.table.names.map(name => [name, points.column(name)[row]]), 500)));
    boardChart.element.querySelector('h2').textContent = `Board of the point: ${keysOf(row)}`;
    boardChart.element.scrollIntoView({block: 'nearest'});
  };
  const scatter = addScatter(cards, points, {choose});
  const boardChart = addChart(cards, {id: 'chosen', wide: true, title: 'The board of a point', body: board});
  addFilters(cards, points);
  addParallel(cards, points);
  addTable(cards, points, [rateName, ...(points.figures.includes('area.slices') ? ['area.slices'] : [])], choose);
  addChart(cards, {id: 'constants', wide: true, title: `${points.constantKeys.length} keys are the same in all points`,
    body: h('details', null, h('summary', null, 'Show'), htmlTable(['key', 'value'], points.constantKeys.map(key => [key, points.column(key)[0]]), 300)),
    numbers: () => [['key', 'value'], points.constantKeys.map(key => [key, points.column(key)[0]])]});
}
