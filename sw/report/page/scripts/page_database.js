// The page of a database: scatter, filters, parallel coordinates, table, and the board of a point.
import {addChart, htmlTable} from './chart.js';
import {textBox} from './chart_config.js';
import {addParallel} from './chart_parallel.js';
import {addScatter} from './chart_scatter.js';
import {addFilters, addTable} from './database_table.js';
import {h} from './dom.js';
import {count, fixed, value, whole} from './format.js';
import {addAnswers, addGroup, addHead} from './page_parts.js';
import {Points} from './points.js';
import {Boards} from './table.js';


export function showDatabase(page, {database}) {
  const points = new Points(database);
  const boards = new Boards(database.boards, points.size);
  const rateName = points.figures.find(name => name.startsWith('frames_per_second')) ?? points.figures[0];
  const rates = points.column(rateName);
  let best = 0;
  for (let row = 1; row < points.size; ++row)
    if (!(rates[row] <= rates[best])) best = row;
  const keysOf = row => points.keys.map(key => `${key} ${value(points.column(key)[row])}`).join(', ');
  const names = new Set(points.table.has('name') ? points.column('name') : []);
  const statuses = points.table.has('status') ? points.column('status') : [];
  const bad = statuses.filter(status => status !== 'ok').length;
  addHead(page, {
    kind: 'database',
    name: database.path,
    headline: `${count(points.size, 'point')}: at most ${fixed(rates[best], 2)} ${
        rateName.startsWith('frames') ? 'frames/s' : rateName}`,
    sub:
        h('p', {class: 'note'},
          `${names.size === 1 ? `${[...names][0]}: ` : ''}${points.keys.length} keys vary${
              bad ? `; ${whole(bad)} points are impossible or have failed` : ''}.`)
  });
  const limited = points.figures.find(name => name.endsWith('limited_by'));
  const tally = new Map();
  if (limited)
    for (const name of points.column(limited)) tally.set(name, (tally.get(name) ?? 0) + 1);
  addAnswers(page, [
    ['Which is the fastest?', [`${fixed(rates[best], 2)} frames/s: ${keysOf(best)}.`]],
    [
      'What limits?',
      limited ?
          [[...tally]
               .filter(([name]) => name !== null)
               .sort((a, b) => b[1] - a[1])
               .slice(0, 4)
               .map(([name, all]) => `${name} in ${whole(all)}`)
               .join(', ') +
           ' points.'] :
          []
    ],
    [
      'What is the same in all?',
      [`${points.constantKeys.length} keys, such as ${
          points.constantKeys.filter(key => key.startsWith('matcher') || key.startsWith('image'))
              .slice(0, 3)
              .map(key => `${key} ${value(points.column(key)[0])}`)
              .join(', ')}.`]
    ],
    [
      'What is left out?',
      [`${
          whole(database.left_out
                    .length)} columns, most of them counters of banks and ports: the database has them.`]
    ]
  ].filter(([, texts]) => texts.length));

  const cards = addGroup(page, 'Points');
  const board = h('div', {id: 'board'}, h('p', {class: 'note'}, 'Click a point, or a line of the table.'));
  const choose = row => {
    points.chosen = row;
    scatter.redraw();
    const text = boards.text(row);
    board.replaceChildren(
        textBox(text, `point_${row}.yaml`),
        h('details', null, h('summary', null, 'All figures'),
          htmlTable(
              ['column', 'value'], points.table.names.map(name => [name, points.column(name)[row]]), 500)));
    boardChart.element.querySelector('h2').textContent = `Board of the point: ${keysOf(row)}`;
    boardChart.element.scrollIntoView({block: 'nearest'});
  };
  const scatter = addScatter(cards, points, {choose});
  const boardChart = addChart(cards, {id: 'chosen', wide: true, title: 'The board of a point', body: board});
  addFilters(cards, points);
  addParallel(cards, points);
  addTable(
      cards, points, [rateName, ...(points.figures.includes('area.slices') ? ['area.slices'] : [])], choose);
  addChart(cards, {
    id: 'constants',
    wide: true,
    title: `${points.constantKeys.length} keys are the same in all points`,
    body:
        h('details', null, h('summary', null, 'Show'),
          htmlTable(['key', 'value'], points.constantKeys.map(key => [key, points.column(key)[0]]), 300)),
    numbers: () => [['key', 'value'], points.constantKeys.map(key => [key, points.column(key)[0]])]
  });
}
