// Who waits for whom, by cause and from top to bottom of the picture.
import {drawBars} from './bars.js';
import {addChart, addLeftOut, legend} from './card.js';
import {commandLine, h, note, s} from './dom.js';
import {blamesInDetail, blamesOf, blameText, settingOf, waitingRows, waitsOf, waitText} from './findings.js';
import {bankText, count, least, most, percent, signed, sum, whole} from './format.js';
import {lastRow, linesOf, rowsText} from './data.js';
import {
    addBrush, axisBelow, axisLeft, cut, drawing, layeredDrawing, numeric, textWidth, Zoom,
} from './plot.js';
import {css, heat, inkOn, namedColour} from './theme.js';
import {mark} from './tooltip.js';

const kMostDifferences = 20;
const kLeastRows = 4;
const kRowsHeight = 328;
const kMostBands = 240;
const kNoCycle = 1e-3;  // a mean over lanes is rounded

const bare = share => percent(share).replace(' %', '');

// A row for each bank and cause, a column for each port. The sum of a column must be the stalls that the port
// itself has counted.
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
  const placeOf = ({bank, by}) => `${bankText(bank)} · ${by}`;
  const causes = [...new Set(blames.map(placeOf))];
  const highest = most(blames.map(row => row.share));
  const cellOf = (port, cause) => {
    const row = blames.find(each => each.port === port.name && placeOf(each) === cause);
    if (!row) return h('td', {class: 'empty'});
    const colour = heat(0.15 + 0.85 * row.share / highest);
    const style = `background:${css(colour)};color:${inkOn(colour)}`;
    return mark(
        h('td', {style}, bare(row.share)),
        [blameText(row), `${whole(row.cycles)} of ${whole(cycles)} cycles`]);
  };
  const totalOf = port => sum(blames.filter(row => row.port === port.name).map(row => row.cycles));
  const counterOf = port => Math.abs(totalOf(port) - port.stall_cycles) < kNoCycle ?
      h('td', {class: 'good'}, '✓') :
      h('td', {class: 'bad'}, `≠ ${bare(port.stall_cycles / cycles)}`);
  const rowOf = (name, cells, attributes) => h('tr', attributes, h('th', {scope: 'row'}, name), cells);
  const draw = host => host.append(
      h('table', {class: 'heat'},
        rowOf('on bank · for', ports.map(({name}) => h('th', {scope: 'col'}, name.replace('_', ' ')))),
        causes.map(cause => rowOf(cause, ports.map(port => cellOf(port, cause)))),
        rowOf('sum', ports.map(port => h('td', null, bare(totalOf(port) / cycles))), {class: 'sum'}),
        rowOf('counter', ports.map(counterOf))));
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
  for (const [run, side] of [[a, 'a'], [b, 'b']]) {
    for (const {port, bank, by, cycles} of blamesInDetail(run)) {
      const text = `${port} on ${bankText(bank)} for ${by}`;
      if (!all.has(text)) all.set(text, {text, port, bank, by, a: 0, b: 0});
      all.get(text)[side] += cycles;
    }
  }
  const rows = [...all.values()].map(row => ({...row, more: row.b - row.a})).filter(({more}) => more !== 0);
  rows.sort((x, y) => Math.abs(y.more) - Math.abs(x.more));
  if (rows.length === 0) {
    addChart(
        page,
        {id: 'blame', title: 'Ports wait equally in both runs', note: 'Every wait has the same cause.'});
    return;
  }
  const largest = Math.abs(rows[0].more);
  const rowOf = ({text, a: inA, b: inB, more}) => ({
    name: text,
    bars: [{
      from: 0,
      to: more,
      colour: more > 0 ? '--vermilion' : '--blue',
      lines: [text, `A: ${whole(inA)} cycles`, `B: ${whole(inB)} cycles`]
    }],
    texts: [signed(more, whole)]
  });
  addChart(page, {
    id: 'blame',
    title: `${rows[0].text}: ${signed(rows[0].more, whole)} cycles in B`,
    draw: host => drawBars(
        host, {rows: rows.slice(0, kMostDifferences).map(rowOf), domain: [-largest, largest], above: true}),
    note: 'Cycles of waiting in B less those in A, by port, bank and cause.',
    numbers: () => [
        ['port', 'bank', 'by', 'cycles_a', 'cycles_b', 'difference'],
        rows.map(row => [row.port, row.bank, row.by, row.a, row.b, row.more])]
  });
}

// The columns of the map of rows: {name, what, values, fill, most, parts, waits}. values: the amount of each
// line, at most `most` per cycle; waits: whether the amounts are waits.
function columnsOf(run, {accesses, stalls}) {
  const used = [...new Set(accesses.map(({bank}) => bank))].map(name => {
    const parts = accesses.filter(({bank}) => bank === name);
    return {
      name: bankText(name),
      what: 'makes accesses',
      values: parts[0].values.map((_, line) => sum(parts.map(part => part.values[line]))),
      fill: sum(parts.map(part => part.fill)),
      most: run.banks.find(bank => bank.name === name).accesses_per_cycle,
      parts
    };
  });
  const waits = stalls.map(({port, bank, by, values, fill}) => ({
                             name: `${port} · ${by}`,
                             what: `waits on ${bankText(bank)}`,
                             values,
                             fill,
                             most: 1,
                             parts: [],
                             waits: true
                           }));
  return [...used, ...waits];
}

// The command that traces the longest wait among these lines in the longest frame; null: no port waits.
function traceCommand(run, recorded, {from, to}) {
  if (!recorded.stalls.some(({values}) => values.slice(from, to).some(each => each !== 0))) return null;
  const cycles = run.stats.frame_cycles;
  const last = lastRow(recorded, to - 1, settingOf(run, 'image.height'));
  return `${run.command.replace(/ --out DIR$/, '')} --trace vcd:waits.vcd --trace-window frame=${
      cycles.indexOf(most(cycles))},rows=${from * recorded.height}..${last},longest-wait`;
}

// What happens from top to bottom of the picture: use of the banks and waits. A range of rows can be brushed
// to look closer.
export function addRows(page, run) {
  const recorded = linesOf(run);
  if (!recorded) return addLeftOut(page, 'rows', 'What happens in each row');
  const {cycles, lines, height: rowsOfLine, frames} = recorded;
  const imageHeight = settingOf(run, 'image.height');
  const columns = columnsOf(run, recorded);
  const shareOf = (column, line) => cycles[line] > 0 ? column.values[line] / cycles[line] / column.most : 0;
  const mostWaits = Math.max(
      0,
      most(columns.filter(({waits}) => waits)
               .flatMap(column => cycles.map((_, line) => shareOf(column, line)))));
  const tipOf = (column, line) =>
      [`${rowsText(recorded, line, line + 1, imageHeight)}: ${column.name} ${column.what} in ${
           percent(shareOf(column, line))} of the cycles`,
       `${whole(column.values[line])} in ${whole(cycles[line])} cycles`,
       ...column.parts.length > 1 ? column.parts.filter(part => part.values[line] > 0)
                                        .map(part => `${part.by}: ${whole(part.values[line])}`) :
                                    []];
  const draw = (host, width) => {
    // Names from bottom to top, unless each has room.
    const widest = Math.max(...columns.map(({name}) => textWidth(name)));
    const upright = widest + 6 > (width - 48) / columns.length;
    const top = upright ? Math.min(200, 16 + widest) : 24;
    const {plot, width: inner, height, context} = layeredDrawing(
        host, width, kRowsHeight + top + 8, {left: 44, right: 4, top, bottom: 8}, 'Rows of the picture');
    const y = numeric([zoom.from * rowsOfLine, zoom.to * rowsOfLine], [0, height]);
    const step = inner / columns.length;
    const lineAt = pixel => Math.floor(y.invert(pixel) / rowsOfLine);
    columns.forEach((column, i) => {
      for (let pixel = 0; pixel < height; ++pixel) {
        const first = lineAt(pixel);
        const end = Math.max(first + 1, lineAt(pixel + 1));
        let share = 0;
        for (let line = first; line < end; ++line) share = Math.max(share, shareOf(column, line));
        context.fillStyle = css(heat(column.waits && mostWaits > 0 ? share / mostWaits : share));
        context.fillRect(i * step + 1, pixel, Math.max(1, step - 2), 1.5);
      }
      const place = upright ? {transform: `translate(${(i + 0.5) * step + 4} -6) rotate(-90)`} :
                              {x: (i + 0.5) * step, y: -6, 'text-anchor': 'middle'};
      const some = column.values.filter(each => each !== 0).length;
      const reach =
          {x: i * step + 1, y: 4 - top, width: Math.max(1, step - 2), height: top - 6, class: 'reach'};
      plot.append(s('text', place, cut(column.name, upright ? top - 10 : step)), mark(s('rect', reach), [
                    `${column.name} ${column.what}`, `${whole(sum(column.values) + column.fill)} in all`,
                    `in ${some} of ${count(lines, rowsOfLine > 1 ? 'strip' : 'row')}`
                  ]));
    });
    plot.append(axisLeft(y, inner, height, 'row', {grid: false, ticks: 8}));
    addBrush(plot, {
      axis: 'y',
      width: inner,
      height,
      end: box => {
        if (!box) return;
        const [from, to] = [lineAt(box.y0), Math.ceil(y.invert(box.y1) / rowsOfLine)];
        if (to - from >= kLeastRows) zoom.set(from, to);
      },
      tip: ({x, y: pixel}) => {
        const [column, line] = [columns[Math.floor(x / step)], lineAt(pixel)];
        return column && line >= 0 && line < lines ? tipOf(column, line) : null;
      }
    });
  };
  const shownText = h('span', {class: 'note'});
  const trace = h('div');
  const sayShown = () => {
    shownText.textContent = rowsText(recorded, zoom.from, zoom.to, imageHeight);
    const command = traceCommand(run, recorded, zoom);
    trace.replaceChildren(
        ...command ?
            [
              note(
                  'The cycles around the longest wait in these rows of the longest frame, ' +
                  'for a waveform viewer:'),
              commandLine(command)
            ] :
            []);
  };
  const zoom =
      new Zoom({last: lines, least: kLeastRows, step: 0.25}, [['▲', 'Up'], ['▼', 'Down'], 'All rows'], () => {
        sayShown();
        chart.redraw();
      });
  zoom.controls.append(shownText);
  const chart = addChart(page, {
    id: 'rows',
    draw,
    body: [zoom.controls, trace],
    title: `Ports wait ${waitingRows(run) ?? 'in no row of the picture'}`,
    note: `Banks: the share of the cycles of each row with an access. Ports: the share in which they wait. ` +
        `Sums over ${count(frames, 'frame')}. The colours of banks end at 100 %${
              mostWaits > 0 ? `, those of waits at the most of them in any row, ${percent(mostWaits)}` :
                              ''}. ` +
        'Drag over rows to zoom in.',
    numbers: () => {
      const named = [
        ...recorded.accesses.map(each => [`${each.bank} ${each.by} accesses`, each]),
        ...recorded.stalls.map(each => [`${each.port} on ${each.bank} for ${each.by}`, each])
      ];
      const rowOf = (all, line) =>
          [line * rowsOfLine, lastRow(recorded, line, imageHeight), all,
           ...named.map(([, {values}]) => values[line])];
      return [
        ['first_row', 'last_row', 'cycles', ...named.map(([name]) => name)],
        [['', '', recorded.fill, ...named.map(([, {fill}]) => fill)], ...cycles.map(rowOf)]
      ];
    }
  });
  sayShown();
}

// Cycles that each row takes more in B, beside the waits.
export function addRowDifference(page, {rows}) {
  if (rows.not_compared)
    return addChart(page, {id: 'rows', title: 'Rows cannot be compared', note: rows.not_compared});
  const {cycles, parting} = rows;
  const ports = Object.entries(rows.stalls).filter(([, values]) => values.some(value => value !== 0));
  const size = Math.ceil(cycles.length / kMostBands);
  const bands = [];
  for (let row = 0; row < cycles.length; row += size) bands.push([row, Math.min(cycles.length, row + size)]);
  const over = (values, [from, to]) => sum(values.slice(from, to)) / (to - from) / rows.frames;
  const draw = (host, width) => {
    const {plot, width: inner, height} =
        drawing(host, width, 420, {left: 44, right: 12, top: 22, bottom: 40}, 'Difference by row');
    const means = [cycles, ...ports.map(([, values]) => values)].flatMap(
        values => bands.map(band => over(values, band)));
    const x = numeric([Math.min(0, least(means)), Math.max(0, most(means)) || 1], [0, inner]);
    const y = numeric([0, cycles.length], [0, height]);
    const barOf = band => {
      const [from, to] = band;
      const [left, right] = [0, over(cycles, band)].map(x).sort((a, b) => a - b);
      const place = {x: left, y: y(from), width: Math.max(0.5, right - left), height: y(to) - y(from) + 0.4};
      return mark(s('rect', {...place, class: 'row-bar'}), [
        to - from > 1 ? `rows ${from} to ${to - 1}` : `row ${from}`,
        `${signed(over(cycles, band), whole)} cycles a frame`,
        ...ports.map(([port, values]) => `${port}: ${signed(over(values, band), whole)} of waiting`)
      ]);
    };
    const lineOf = ([port, values]) => s('polyline', {
      class: 'line',
      style: `stroke:var(${namedColour(port)})`,
      points: bands.map(band => [x(over(values, band)), y((band[0] + band[1]) / 2)]).join(' ')
    });
    plot.append(
        axisBelow(x, inner, height, 'cycles a row and frame, B − A'),
        axisLeft(y, inner, height, 'row', {grid: false}), ...bands.map(barOf), ...ports.map(lineOf),
        s('line', {x1: x(0), x2: x(0), y1: 0, y2: height, class: 'base'}));
    if (!parting) return;
    const at = y(parting.row);
    plot.append(
        s('line', {x1: 0, x2: inner, y1: at, y2: at, class: 'now'}),
        s('text',
          {x: inner, y: at + (parting.row < 20 ? 14 : -5), 'text-anchor': 'end', class: 'now-label halo'},
          `they part: row ${parting.row}`));
  };
  addChart(page, {
    id: 'rows',
    draw,
    title: parting ? `They part in frame ${parting.frame}, row ${parting.row}: whole after ${
                         whole(parting.cycles_a)} cycles in A, ${whole(parting.cycles_b)} in B` :
                     'All rows are whole in the same cycles',
    note: `How much longer each row takes in B, and how much longer each port waits; ${
        signed(sum(cycles), whole)} cycles in ${count(rows.frames, 'frame')}.`,
    body: legend([
      ['cycles of the row', 'var(--row-bar)'],
      ...ports.map(([port]) => [`waits of ${port}`, `var(${namedColour(port)})`])
    ]),
    numbers: () => [
        ['row', 'cycles', ...ports.map(([port]) => `${port} stalls`)],
        cycles.map((all, row) => [row, all, ...ports.map(([, values]) => values[row])])]
  });
}
