// The page of a database: scatter, filters, parallel coordinates, table, and the board of a point.
import {addChart, htmlTable} from './chart.js';
import {textBox} from './chart_config.js';
import {addParallel} from './chart_parallel.js';
import {addScatter} from './chart_scatter.js';
import {addFilters, addTable} from './database_table.js';
import {h} from './dom.js';
import {resourceText} from './findings.js';
import {capital, count, fixed, kRates, rateWith, value, whole} from './format.js';
import {addAnswers, addGroup, addHead} from './page_parts.js';
import {kRateColumns, Points} from './points.js';
import {Boards} from './table.js';


export function showDatabase(page, {database}) {
  const points = new Points(database);
  const boards = new Boards(database.boards, points.size);
  const hasNumbers = name =>
      points.table.has(name) && points.column(name).some(each => typeof each === 'number');
  const rateName = kRateColumns.find(hasNumbers) ?? points.figures[0];
  const kind = kRates[kRateColumns.indexOf(rateName)];
  const {best, ties} = points.fastest(rateName);
  const [named] = ties;
  const rateText = row => {
    const [amount, open] = [points.column(rateName)[row], points.uncertainty(rateName)[row]];
    return kind ? `${rateWith(amount, open)} frames/s, ${kind[1]}` : `${fixed(amount, 2)} ${rateName}`;
  };
  const keysOf = row => points.keys.map(key => `${key} ${value(points.column(key)[row])}`).join(', ');
  const names = new Set(points.table.has('name') ? points.column('name') : []);
  const statuses = points.table.has('status') ? points.column('status') : [];
  const bad = statuses.filter(status => status !== 'ok').length;
  addHead(page, {
    kind: 'database',
    name: database.path,
    headline: `${count(points.size, 'point')}: ${named ? `at most ${rateText(best)}` : 'none has a rate'}`,
    sub:
        h('p', {class: 'note'},
          `${names.size === 1 ? `${[...names][0]}: ` : ''}${points.keys.length} keys vary${
              bad ? `; ${whole(bad)} points are impossible or have failed` : ''}.`)
  });
  // Of points with cameras, what sets the bound of the whole computer.
  const [ofSystem, ofCore] = ['system', 'core']
                                 .map(each => `bound.${each}_limited_by`)
                                 .map(name => points.table.has(name) ? points.column(name) : []);
  const tally = new Map();
  for (let row = 0; row < points.size; ++row) {
    const name = ofSystem[row] ?? ofCore[row];
    if (name) tally.set(name, (tally.get(name) ?? 0) + 1);
  }
  addAnswers(page, [
    [
      'Which is the fastest?',
      named ?
          [
            `${[rateText(named.row), keysOf(named.row)].filter(Boolean).join(': ')}.`,
            ties.length > 1 &&
                `${count(ties.length, 'point')} ${
                    points.hasUncertainty(rateName) ? 'tie within the uncertainty of their rates' :
                                                      'have this rate'}. This is the cheapest: ${
                    count(named.banks, 'bank')}, ${whole(named.slices)} slices.`
          ] :
          []
    ],
    [
      'What limits?',
      tally.size > 0 ?
          [`${
              capital([...tally]
                          .sort((a, b) => b[1] - a[1])
                          .slice(0, 4)
                          .map(
                              ([name, all], i) =>
                                  `${resourceText(name)} in ${i ? whole(all) : count(all, 'point')}`)
                          .join(', '))}.`] :
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
