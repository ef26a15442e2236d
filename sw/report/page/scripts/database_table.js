// The filters and the table of a database.
import {addChart, htmlTable} from './chart.js';
import {h} from './dom.js';
import {count, shortened, value, whole} from './format.js';

const kMostChips = 16;
const kRowsShown = 100;

// Filters: the values of each key that varies, to be switched off and on.
export function addFilters(page, points) {
  const off = new Map();
  const shown = points.keys.filter(key => new Set(points.column(key)).size <= kMostChips);
  if (points.table.has('status') && !points.table.isConstant('status')) shown.unshift('status');
  const groups = shown.map(key => {
    const values = points.column(key);
    const words =
        [...new Set(values)].sort((a, b) => typeof a === 'number' ? a - b : value(a).localeCompare(value(b)));
    off.set(key, new Set());
    return h(
        'fieldset', null, h('legend', null, key),
        words.map(
            word => h(
                'label', {class: 'chip'}, h('input', {
                  type: 'checkbox',
                  checked: true,
                  'data-key': key,
                  'data-value': value(word),
                  change: event => {
                    if (event.target.checked)
                      off.get(key).delete(word);
                    else
                      off.get(key).add(word);
                    points.filter(
                        `chips ${key}`, off.get(key).size > 0 ? row => !off.get(key).has(values[row]) : null);
                  }
                }),
                ` ${value(word)}`)));
  });
  const reset =
      h('button', {
        type: 'button',
        class: 'small',
        id: 'reset-filters',
        click: () => {
          for (const box of groups.flatMap(group => [...group.querySelectorAll('input')])) box.checked = true;
          for (const set of off.values()) set.clear();
          for (const name of [...points.filters.keys()]) points.filters.delete(name);
          points.filter('', null);
        }
      },
        'Select all points');
  addChart(
      page,
      {id: 'filters', wide: true, title: 'Filters', body: [h('div', {class: 'filters'}, groups), reset]});
}

// The table of the selected points, sorted by one column.
export function addTable(page, points, first, choose) {
  const names =
      [...first, ...points.keys, ...points.figures.filter(name => !first.includes(name)).slice(0, 4)];
  const state = {by: first[0], down: true};
  const host = h('div');
  const rowsInOrder = () => {
    const values = points.column(state.by);
    const rows = [];
    for (let row = 0; row < points.size; ++row)
      if (points.selected[row]) rows.push(row);
    const sign = state.down ? -1 : 1;
    return rows.sort((a, b) => {
      const [x, y] = [values[a], values[b]];
      if (x === null || y === null) return (x === null) - (y === null);
      return sign *
          (typeof x === 'number' && typeof y === 'number' ? x - y : value(x).localeCompare(value(y)));
    });
  };
  const show = () => {
    const rows = rowsInOrder();
    const table = htmlTable(
        ['', ...names],
        rows.slice(0, kRowsShown)
            .map(
                row =>
                    [h('button', {type: 'button', class: 'small', 'data-row': row, click: () => choose(row)},
                       'Board'),
                     ...names.map(name => shortened(points.column(name)[row]))]));
    table.querySelectorAll('th').forEach((cell, i) => {
      if (i === 0) return;
      const name = names[i - 1];
      cell.setAttribute('aria-sort', state.by === name ? (state.down ? 'descending' : 'ascending') : 'none');
      cell.replaceChildren(
          h('button', {
            type: 'button',
            class: 'sort',
            click: () => {
              state.down = state.by === name ? !state.down : true;
              state.by = name;
              show();
            }
          },
            `${name}${state.by === name ? (state.down ? ' ↓' : ' ↑') : ''}`));
    });
    host.replaceChildren(
        table,
        h('p', {class: 'note'},
          rows.length > kRowsShown ?
              `The first ${kRowsShown} of ${whole(rows.length)} points; the CSV has all.` :
              `${count(rows.length, 'point')}.`));
  };
  points.whenSelected(final => final && show());
  show();
  addChart(page, {
    id: 'points',
    wide: true,
    title: 'The selected points',
    body: host,
    note: 'Click a column to sort by it.',
    numbers: () => {
      const all = points.table.names.filter(name => !points.table.isConstant(name));
      return [all, rowsInOrder().map(row => all.map(name => points.column(name)[row]))];
    }
  });
}
