// What happens in each row of the picture: use of the banks and stalls, row by row. A range of rows can be
// brushed to look closer.
import {addBrush} from './brush.js';
import {addChart, canvasOf, cut, drawing} from './chart.js';
import {h, s} from './dom.js';
import {whereText} from './findings.js';
import {count, percent, whole} from './format.js';
import {axisLeft, linear} from './scale.js';
import {unpack} from './table.js';
import {css, heat} from './theme.js';
import {hideTooltip, mark, showTooltip} from './tooltip.js';

const sumOf = numbers => numbers.reduce((total, number) => total + number, 0);

// The columns of the map: {name, of, values}: `values` in cycles, one for each row.
function columnsOf(run) {
  const {recording, rows} = run;
  const height = rows.cycles.length;
  if (!recording?.rows) {
    return Object.entries(rows.stalls).map(([port, values]) => ({name: port, of: 'waits', values}));
  }
  const use =
      recording.rows.banks.map(({bank, busy}) => ({name: bank, of: 'is busy', values: unpack(busy, height)}));
  const stalls = recording.rows.stalls.map(
      ({port, bank, by, cycles}) =>
          ({name: `${port} · ${by}`, of: `waits on ${bank}`, values: unpack(cycles, height)}));
  return [...use, ...stalls];
}

// A map with a column for each of `columns` and a line for each row. `shareOf(value, row)`: 0 to 1.
export function addRowMap(page, {id, title, note, columns, shareOf, tipOf, numbers, wide}) {
  const rows = columns[0].values.length;
  const state = {from: 0, to: rows};
  const draw = (host, width) => {
    const upright = (width - 48) / columns.length < 44;  // names from bottom to top
    const top = upright ? 96 : 44;
    const {plot, width: inner, height, svg} =
        drawing(host, width, 380 + top - 44, {left: 44, right: 4, top, bottom: 8}, title);
    const y = linear([state.from, state.to], [0, height]);
    const step = inner / columns.length;
    const {canvas, context} = canvasOf(inner, height);
    canvas.style.cssText += `;position:absolute;left:44px;top:${top}px`;
    host.prepend(canvas);
    host.classList.add('layered');
    const shownRows = state.to - state.from;
    columns.forEach((column, i) => {
      for (let line = 0; line < height; ++line) {
        const first = state.from + Math.floor(line / height * shownRows);
        const last = Math.max(first + 1, state.from + Math.floor((line + 1) / height * shownRows));
        let share = 0;
        for (let row = first; row < last; ++row) {
          const its = shareOf(column.values[row], row);
          if (Math.abs(its) > Math.abs(share)) share = its;
        }
        context.fillStyle = css(heat(Math.abs(share)));
        context.fillRect(i * step + 1, line, Math.max(1, step - 2), 1.5);
      }
    });
    plot.append(axisLeft(y, inner, height, 'row', {grid: false, ticks: 8}));
    columns.forEach((column, i) => {
      const words = column.name.split(step < 70 ? /(?<=_)| · / : ' · ');
      if (upright) {
        plot.append(s(
            'text', {transform: `translate(${(i + 0.5) * step + 4} -6) rotate(-90)`}, cut(column.name, 86)));
      } else
        words.slice(0, 2).forEach(
            (word, line) => plot.append(
                s('text', {
                  x: i * step + step / 2,
                  y: -6 - 13 * (Math.min(words.length, 2) - 1 - line),
                  'text-anchor': 'middle'
                },
                  cut(word, step))));
      const total = sumOf(column.values);
      const some = column.values.filter(each => each !== 0).length;
      plot.append(mark(
          s('rect',
            {x: i * step + 1, y: 4 - top, width: Math.max(1, step - 2), height: top - 6, class: 'reach'}),
          [
            `${column.name} ${column.of}`, `${whole(total)} cycles in all`,
            `in ${some} of ${count(rows, 'row')}`
          ]));
    });
    const {area} = addBrush(plot, {
      axis: 'y',
      width: inner,
      height,
      end: box => {
        if (!box) return;
        const [from, to] = [Math.floor(y.invert(box.y0)), Math.ceil(y.invert(box.y1))];
        if (to - from >= 4) zoom(from, to);
      }
    });
    area.classList.add('hovers');
    area.addEventListener('pointermove', event => {
      const box = area.getBoundingClientRect();
      const row = Math.floor(y.invert((event.clientY - box.top) / box.height * height));
      const column = columns[Math.floor((event.clientX - box.left) / box.width * columns.length)];
      if (column && row >= 0 && row < rows) showTooltip(tipOf(column, row), event.clientX, event.clientY);
    });
    area.addEventListener('pointerleave', hideTooltip);
    svg.style.position = 'relative';
  };
  const shownText = h('span', {class: 'note'});
  const zoom = (from, to) => {
    state.from = Math.max(0, Math.min(rows - 4, Math.round(from)));
    state.to = Math.min(rows, Math.max(state.from + 4, Math.round(to)));
    shownText.textContent = `rows ${state.from} to ${state.to - 1}`;
    chart.redraw();
  };
  const button = (label, name, from, to) =>
      h('button', {
        type: 'button',
        class: 'small',
        'aria-label': name,
        click: () => {
          const size = state.to - state.from;
          zoom(state.from + from * size, state.to + to * size);
        }
      },
        label);
  const tools =
      h('div', {class: 'controls'}, button('+', 'Zoom in', 0.25, -0.25), button('−', 'Zoom out', -0.5, 0.5),
        button('▲', 'Up', -0.25, -0.25), button('▼', 'Down', 0.25, 0.25),
        h('button', {type: 'button', class: 'small', click: () => zoom(0, rows)}, 'All rows'), shownText);
  const chart = addChart(page, {id, title, note, wide, draw, body: tools, numbers});
  shownText.textContent = `rows 0 to ${rows - 1}`;
  return chart;
}

export function addRows(page, run) {
  if (!run.rows) {
    addChart(page, {
      id: 'rows',
      title: 'What happens in each row',
      note: 'Left out by --quick. `stereotlm report` without it repeats the run and counts row by row.'
    });
    return;
  }
  const columns = columnsOf(run);
  const {cycles, frames} = run.rows;
  addRowMap(page, {
    id: 'rows',
    columns,
    title: whereText(run)[0],
    note: `Share of the cycles of each row of results, over ${
              count(frames, 'frame')}: darker (in the dark: lighter) is more. ` +
        'Drag over rows to zoom in.',
    shareOf: (value, row) => cycles[row] > 0 ? value / cycles[row] : 0,
    tipOf: (column, row) =>
        [`row ${row}: ${column.name} ${column.of} ${
             percent(cycles[row] ? column.values[row] / cycles[row] : 0)}`,
         `${whole(column.values[row])} of ${whole(cycles[row])} cycles`],
    numbers: () => [
        ['row', 'cycles', ...columns.map(column => `${column.name} ${column.of}`)],
        cycles.map((all, row) => [row, all, ...columns.map(column => column.values[row])])]
  });
}
