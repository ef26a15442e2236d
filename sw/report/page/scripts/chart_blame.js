// Who waits for whom: a row for each bank and cause, a column for each port that waits. It closes: the sum
// of a column is the stalls that the port itself has counted.
import {addChart, cut, drawing, textWidth} from './chart.js';
import {s} from './dom.js';
import {blamesOf, blameText, detailedBlamesOf, waitsOf, waitText} from './findings.js';
import {percent, whole} from './format.js';
import {css, heat, inkOn} from './theme.js';
import {mark} from './tooltip.js';

const kCellHeight = 30;

export function addBlame(page, run) {
  const blames = blamesOf(run);
  const {cycles, ports} = run.stats;
  if (blames.length === 0) {
    addChart(page, {
      id: 'blame',
      title: 'No port waits for another',
      note: 'In every cycle each port that asks for a bank gets it.'
    });
    return;
  }
  const causes = [...new Set(blames.map(row => `${row.bank}\n${row.by}`))].map(key => key.split('\n'));
  const find = (port, bank, by) =>
      blames.find(row => row.port === port && row.bank === bank && row.by === by);
  const draw = (host, width) => {
    const labels = causes.map(([bank, by]) => `${bank} · ${by}`);
    const left = Math.min(width * 0.34, Math.max(...labels.map(textWidth), 70) + 10);
    const {plot, width: inner} = drawing(
        host, width, (causes.length + 2) * kCellHeight + 56, {left, top: 50}, 'Waits by cause and port');
    const cell = inner / ports.length;
    const most = Math.max(...blames.map(row => row.share));
    ports.forEach((port, column) => {
      const [side, ...rest] = port.name.split('_');
      plot.append(
          s('text', {x: cell * (column + 0.5), y: -20, 'text-anchor': 'middle'}, side),
          s('text', {x: cell * (column + 0.5), y: -6, 'text-anchor': 'middle'}, rest.join('_')));
    });
    plot.append(
        s('text', {x: -8, y: -34, 'text-anchor': 'end', class: 'label'}, 'waits:'),
        s('text', {x: -8, y: -6, 'text-anchor': 'end', class: 'label'}, 'on bank · for'));
    causes.forEach(([bank, by], line) => {
      const y = line * kCellHeight;
      plot.append(s('text', {x: -8, y: y + 19, 'text-anchor': 'end'}, cut(labels[line], left - 8)));
      ports.forEach((port, column) => {
        const row = find(port.name, bank, by);
        const colour = row ? heat(0.15 + 0.85 * row.share / most) : null;
        const box = s('rect', {
          x: cell * column + 1,
          y: y + 1,
          width: Math.max(1, cell - 2),
          height: kCellHeight - 2,
          rx: 2,
          class: row ? null : 'empty',
          style: row && `fill:${css(colour)}`
        });
        plot.append(box);
        if (!row) return;
        mark(box, [blameText(row), `${whole(row.cycles)} of ${whole(cycles)} cycles`]);
        plot.append(
            s('text', {
              x: cell * (column + 0.5),
              y: y + 19,
              'text-anchor': 'middle',
              class: 'value',
              style: `fill:${inkOn(colour)}`
            },
              percent(row.share).replace(' %', '')));
      });
    });
    const end = causes.length * kCellHeight;
    plot.append(
        s('line', {x1: -left, x2: inner, y1: end + 4, y2: end + 4, class: 'base'}),
        s('text', {x: -8, y: end + 22, 'text-anchor': 'end'}, 'sum'),
        s('text', {x: -8, y: end + 44, 'text-anchor': 'end'}, 'counter'));
    ports.forEach((port, column) => {
      const total = blames.filter(row => row.port === port.name).reduce((all, row) => all + row.cycles, 0);
      const x = cell * (column + 0.5);
      const agrees = total === port.stall_cycles;
      plot.append(
          s('text', {x, y: end + 22, 'text-anchor': 'middle'}, percent(total / cycles).replace(' %', '')),
          s('text', {x, y: end + 44, 'text-anchor': 'middle', class: agrees ? 'good' : 'bad'},
            agrees ? '✓' : `≠ ${percent(port.stall_cycles / cycles).replace(' %', '')}`));
    });
  };
  addChart(page, {
    id: 'blame',
    title: waitText(waitsOf(run)[0]),
    draw,
    note:
        `Waits in % of the ${whole(cycles)} cycles of all frames: the port of the column waits on a bank, ` +
        'because the bank serves the one named behind it. ✓: the sum agrees with the counter of the port.',
    numbers: () => [
        ['port', 'bank', 'by', 'cycles', 'percent'],
        blames.map(row => [row.port, row.bank, row.by, row.cycles, 100 * row.share])],
  });
}

// The difference of the blames of two runs, as bars.
export function addBlameDifference(page, a, b) {
  const all = new Map();
  for (const [run, sign] of [[a, -1], [b, 1]]) {
    for (const row of detailedBlamesOf(run)) {
      const key = JSON.stringify([row.port, row.bank, row.by]);
      const known = all.get(key) ?? {port: row.port, bank: row.bank, by: row.by, a: 0, b: 0};
      known[sign < 0 ? 'a' : 'b'] += row.cycles;
      all.set(key, known);
    }
  }
  const rows = [...all.values()]
                   .filter(row => row.a !== row.b)
                   .sort((x, y) => Math.abs(y.b - y.a) - Math.abs(x.b - x.a));
  if (rows.length === 0) {
    addChart(
        page,
        {id: 'blame', title: 'Ports wait equally in both runs', note: 'Every wait has the same cause.'});
    return;
  }
  const most = Math.max(...rows.map(row => Math.abs(row.b - row.a)));
  const text = row => `${row.port} on ${row.bank} for ${row.by}`;
  const sign = row => (row.b > row.a ? '+' : '−') + whole(Math.abs(row.b - row.a));
  const draw = (host, width) => {
    const shown = rows.slice(0, 20);
    const {plot, width: inner} = drawing(host, width, shown.length * 40 + 4, {}, 'Difference of waits');
    shown.forEach((row, line) => {
      const size = Math.abs(row.b - row.a) / most * inner / 2;
      const y = line * 40;
      plot.append(
          s('text', {x: 0, y: y + 12}, cut(text(row), inner - textWidth(sign(row)) - 8)),
          s('text', {x: inner, y: y + 12, 'text-anchor': 'end', class: 'value'}, sign(row)),
          mark(
              s('rect', {
                x: row.b > row.a ? inner / 2 : inner / 2 - size,
                y: y + 18,
                width: Math.max(1, size),
                height: 12,
                style: `fill:var(${row.b > row.a ? '--vermilion' : '--blue'})`
              }),
              [text(row), `A: ${whole(row.a)} cycles`, `B: ${whole(row.b)} cycles`]));
    });
    plot.append(s('line', {x1: inner / 2, x2: inner / 2, y1: 16, y2: shown.length * 40, class: 'base'}));
  };
  addChart(page, {
    id: 'blame',
    title: `${text(rows[0])}: ${sign(rows[0])} cycles in B`,
    draw,
    note: 'Cycles of waiting in B less those in A, by port, bank and cause.',
    numbers: () => [
        ['port', 'bank', 'by', 'cycles_a', 'cycles_b', 'difference'],
        rows.map(row => [row.port, row.bank, row.by, row.a, row.b, row.b - row.a])]
  });
}
