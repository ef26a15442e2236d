// The page of a database: its charts, filters, table, and the board of a point.
import {addAnswers, addChart, addGroup, addHead, htmlTable} from './card.js';
import {addParallel, addScatter} from './database_charts.js';
import {button, folded, h, note, textBox} from './dom.js';
import {resourceText} from './findings.js';
import {
    capital, count, different, fixed, inOrder, kRates, lossText, rateWith, shortened, value, varyText,
    whole,
} from './format.js';
import {kLostPixels, kRateColumns, Points} from './points.js';

const kMostChips = 16;
const kRowsShown = 100;
const kAtBound = 0.005;  // a rate that is below its bound by less is that of the bound

// Filters: the values of each key that varies, to be switched off and on.
function addFilters(page, points) {
  const shown = points.keys.filter(key => new Set(points.column(key)).size <= kMostChips);
  if (points.has('status') && !points.isConstant('status')) shown.unshift('status');
  const groups = shown.map(key => {
    const values = points.column(key);
    const boxes = new Map();
    const change = () => {
      const off = new Set([...boxes].filter(([, box]) => !box.checked).map(([word]) => word));
      points.filter(`chips ${key}`, off.size > 0 ? row => !off.has(values[row]) : null);
    };
    const chips = different(values).map(word => {
      const attributes =
          {type: 'checkbox', checked: true, 'data-key': key, 'data-value': value(word), change};
      boxes.set(word, h('input', attributes));
      return h('label', {class: 'chip'}, boxes.get(word), ` ${value(word)}`);
    });
    return h('fieldset', null, h('legend', null, key), chips);
  });
  const reset = button('Select all points', () => {
    for (const box of groups.flatMap(group => [...group.querySelectorAll('input')])) box.checked = true;
    points.filters.clear();
    points.filter('', null);
  }, {id: 'reset-filters'});
  addChart(
      page,
      {id: 'filters', wide: true, title: 'Filters', body: [h('div', {class: 'filters'}, groups), reset]});
}

// The table of the selected points, sorted by one column.
function addTable(page, points, first, choose) {
  const others = points.figures.filter(name => !first.includes(name)).slice(0, 4);
  const names = [...first, ...points.keys, ...others];
  const state = {by: first[0], down: true};
  const host = h('div');
  const rowsInOrder = () => {
    const values = points.column(state.by);
    const sign = state.down ? -1 : 1;
    return points.selectedRows().sort((a, b) => {
      const [x, y] = [values[a], values[b]];
      return x === null || y === null ? (x === null) - (y === null) : sign * inOrder(x, y);
    });
  };
  const show = () => {
    const rows = rowsInOrder();
    const opener = row => button('Board', () => choose(row), {'data-row': row});
    const [, shown] = points.numbers(names, rows.slice(0, kRowsShown));
    const table = htmlTable(['', ...names], shown.map((row, i) => [opener(rows[i]), ...row.map(shortened)]));
    [...table.querySelectorAll('th')].slice(1).forEach((cell, i) => {
      const name = names[i];
      const sorts = state.by === name;
      const sort = () => {
        Object.assign(state, {by: name, down: sorts ? !state.down : true});
        show();
      };
      cell.setAttribute('aria-sort', sorts ? (state.down ? 'descending' : 'ascending') : 'none');
      cell.replaceChildren(
          button(`${name}${sorts ? (state.down ? ' ↓' : ' ↑') : ''}`, sort, {class: 'sort'}));
    });
    host.replaceChildren(
        table,
        note(
            rows.length > kRowsShown ?
                `The first ${kRowsShown} of ${whole(rows.length)} points; the CSV has all.` :
                `${count(rows.length, 'point')}.`));
  };
  points.whenSelected(show);
  show();
  addChart(page, {
    id: 'points',
    wide: true,
    title: 'The selected points',
    body: host,
    note: 'Click a column to sort by it.',
    numbers: () => points.numbers(points.allNames.filter(name => !points.isConstant(name)), rowsInOrder())
  });
}

// open(yaml): opens the board of a point; null: it cannot be opened.
export function showDatabase(page, {database}, open = null) {
  const {boards} = database;
  const points = new Points(database);
  const hasNumbers = name => points.has(name) && points.column(name).some(each => typeof each === 'number');
  const rateName = kRateColumns.find(hasNumbers) ?? points.figures[0];
  const kind = kRates[kRateColumns.indexOf(rateName)];
  const {best, ties} = points.fastest(rateName);
  const [named] = ties;
  const rateText = row => {
    const [amount, open] = [points.column(rateName)[row], points.uncertainty(rateName)[row]];
    return kind ? `${rateWith(amount, open)} frames/s, ${kind[1]}${lossText(points.lost[row])}` :
                  `${fixed(amount, 2)} ${rateName}`;
  };
  const keysOf = row => points.keys.map(key => `${key} ${value(points.column(key)[row])}`).join(', ');
  const names = new Set(points.has('name') ? points.column('name') : []);
  const statuses = points.has('status') ? points.column('status') : [];
  const bad = statuses.filter(status => status !== 'ok').length;
  const tally = new Map();  // of the points with a rate
  for (let row = 0; row < points.size; ++row) {
    const now = points.first(kRateColumns, row);
    if (now === undefined) continue;
    const [bound, by] = ['', '_limited_by'].map(
        end => points.first([`bound.system${end}`, `bound.core${end}`], row));
    const name = points.lost[row] > 0 ? 'pixels are lost' :
        now < (1 - kAtBound) * bound  ? 'below all bounds' :
                                        `at the bound of ${resourceText(by)}`;
    tally.set(name, (tally.get(name) ?? 0) + 1);
  }
  addHead(page, {
    kind: 'database',
    name: database.path,
    headline: `${count(points.size, 'point')}: ${named ? `at most ${rateText(best)}` : 'none has a rate'}${
        points.losing() > 0 ? `; pixels are lost in ${whole(points.losing())} of them` : ''}`,
    sub:
        h('p', {class: 'note'},
          `${names.size === 1 ? `${[...names][0]}: ` : ''}${varyText(points.keys.length)}${
              bad ? `; ${count(bad, 'point')} ${bad === 1 ? 'is' : 'are'} impossible or failed` : ''}.`)
  });
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
                          .slice(0, 6)
                          .map(([name, all], i) => `${name} in ${i ? whole(all) : count(all, 'point')}`)
                          .join(', '))}.`] :
          []
    ],
  ].filter(([, texts]) => texts.length));

  const cards = addGroup(page, 'Points');
  const board = h('div', {id: 'board'}, note('Click a point, or a line of the table.'));
  const choose = row => {
    points.chosen = row;
    scatter.redraw();
    const figures = points.allNames.map(name => [name, points.textWithLoss(name, row)]);
    const yaml = boards.points[row].map(line => boards.lines[line]).join('');
    board.replaceChildren(
        ...open ? [button('Open this board', () => open(yaml), {id: 'open-point'})] : [],
        textBox(yaml, `point_${row}.yaml`),
        folded('All figures', htmlTable(['column', 'value'], figures, 500)));
    boardChart.element.querySelector('h2').textContent = `Board of the point: ${keysOf(row)}`;
    boardChart.element.scrollIntoView({block: 'nearest'});
  };
  const scatter = addScatter(cards, points, choose);
  const boardChart = addChart(cards, {id: 'chosen', wide: true, title: 'The board of a point', body: board});
  addFilters(cards, points);
  addParallel(cards, points);
  addTable(
      cards, points,
      [rateName, ...[kLostPixels, 'area.slices'].filter(name => points.figures.includes(name))], choose);
  const constants = [['key', 'value'], points.constantKeys.map(key => [key, points.column(key)[0]])];
  addChart(cards, {
    id: 'constants',
    wide: true,
    title: `${points.constantKeys.length} keys are the same in all points`,
    note: `${whole(database.left_out.length)} columns, most of them counters of banks and ports, are not ` +
        'in the page.',
    body: folded('Show', htmlTable(...constants, 300)),
    numbers: () => constants
  });
}
