// The page of two runs: what differs in B.
import {h, s} from './dom.js';
import {count, gainText, grouped, rate, rateWith, shortened, signed, whole} from './format.js';
import {addBlameDifference} from './chart_blame.js';
import {addChart, drawing, htmlTable, legend} from './chart.js';
import {commandLine} from './chart_config.js';
import {addFrames} from './chart_frames.js';
import {addMemoryOfTwo} from './chart_memory.js';
import {addPicture} from './chart_picture.js';
import {addPortStates} from './chart_states.js';
import {kindOfRate, rateOf, resourceText, settingOf, waitsOf, waitText} from './findings.js';
import {addAnswers, addGroup, addHead} from './page_parts.js';
import {axisBelow, axisLeft, linear} from './scale.js';
import {namedColour} from './theme.js';
import {mark} from './tooltip.js';

const kMostBands = 240;

// Settings that differ: [key, value in A, value in B]. The name of the board is the last.
function settingsThatDiffer(a, b) {
  const keys = [...new Set([...a.settings, ...b.settings].map(setting => setting.key))].sort(
      (x, y) => (x === 'name') - (y === 'name'));
  return keys.map(key => [key, settingOf(a, key) ?? '–', settingOf(b, key) ?? '–']).filter(([, x,
                                                                                             y]) => x !== y);
}

// Cycles that each row takes more in B, beside the waits.
function addRowDifference(page, {rows, no_rows: reason}) {
  if (!rows) return addChart(page, {id: 'rows', title: 'Rows cannot be compared', note: reason});
  const ports = Object.entries(rows.stalls).filter(([, values]) => values.some(value => value !== 0));
  const {cycles, parting} = rows;
  const total = cycles.reduce((a, b) => a + b, 0);
  const band = Math.ceil(cycles.length / kMostBands);
  const bands = Array.from(
      {length: Math.ceil(cycles.length / band)},
      (_, i) => [i * band, Math.min(cycles.length, (i + 1) * band)]);
  const over = (values, [from, to]) =>
      values.slice(from, to).reduce((a, b) => a + b, 0) / (to - from) / rows.frames;
  const draw = (host, width) => {
    const {plot, width: inner, height} =
        drawing(host, width, 420, {left: 44, right: 12, top: 22, bottom: 40}, 'Difference by row');
    const series = [['cycles', cycles], ...ports];
    const means = series.flatMap(([, values]) => bands.map(rowsOf => over(values, rowsOf)));
    const x = linear([Math.min(0, ...means), Math.max(0, ...means) || 1], [0, inner]);
    const y = linear([0, cycles.length], [0, height]);
    plot.append(
        axisBelow(x, inner, height, 'cycles a row and frame, B − A'),
        axisLeft(y, inner, height, 'row', {grid: false}));
    for (const rowsOf of bands) {
      const value = over(cycles, rowsOf);
      plot.append(mark(
          s('rect', {
            x: Math.min(x(0), x(value)),
            y: y(rowsOf[0]),
            width: Math.max(0.5, Math.abs(x(value) - x(0))),
            height: y(rowsOf[1]) - y(rowsOf[0]) + 0.4,
            class: 'row-bar'
          }),
          [
            rowsOf[1] - rowsOf[0] > 1 ? `rows ${rowsOf[0]} to ${rowsOf[1] - 1}` : `row ${rowsOf[0]}`,
            `${signed(value, whole)} cycles a frame`,
            ...ports.map(([port, values]) => `${port}: ${signed(over(values, rowsOf), whole)} of waiting`)
          ]));
    }
    for (const [port, values] of ports) {
      plot.append(s('polyline', {
        class: 'line',
        style: `stroke:var(${namedColour(port)})`,
        points: bands.map(rowsOf => `${x(over(values, rowsOf))},${y((rowsOf[0] + rowsOf[1]) / 2)}`).join(' ')
      }));
    }
    plot.append(s('line', {x1: x(0), x2: x(0), y1: 0, y2: height, class: 'base'}));
    if (parting) {
      plot.append(
          s('line', {x1: 0, x2: inner, y1: y(parting.row), y2: y(parting.row), class: 'now'}),
          s('text', {
            x: inner,
            y: y(parting.row) + (parting.row < 20 ? 14 : -5),
            'text-anchor': 'end',
            class: 'now-label halo'
          },
            `they part: row ${parting.row}`));
    }
  };
  addChart(page, {
    id: 'rows',
    draw,
    title: parting ? `They part in frame ${parting.frame}, row ${parting.row}: whole after ${
                         whole(parting.cycles_a)} cycles in A, ${whole(parting.cycles_b)} in B` :
                     'All rows are whole in the same cycles',
    note: `How much longer each row takes in B, and how much longer each port waits; ${
        signed(total, whole)} cycles in ${count(rows.frames, 'frame')}.`,
    body: legend([
      ['cycles of the row', 'var(--row-bar)'],
      ...ports.map(([port]) => [`waits of ${port}`, `var(${namedColour(port)})`])
    ]),
    numbers: () => [
        ['row', 'cycles', ...ports.map(([port]) => `${port} stalls`)],
        cycles.map((all, row) => [row, all, ...ports.map(([, values]) => values[row])])]
  });
}

function addTotals(page, a, b) {
  const rows = [];
  const walk = (path, x, y) => {
    if (typeof x === 'number' && typeof y === 'number') return x !== y && rows.push([path, x, y, y - x]);
    if (x && y && typeof x === 'object' && typeof y === 'object') {
      for (const key of Object.keys(x)) walk(path ? `${path}.${x[key]?.name ?? key}` : key, x[key], y[key]);
    }
  };
  for (const key
           of ['cycles', 'frames', 'frames_per_second', 'bound', 'latency_ms', 'area', 'banks', 'ports',
               'cameras', 'pci', 'bridge'])
    walk(key, a.stats[key], b.stats[key]);
  addChart(page, {
    id: 'totals',
    title: rows.length ?
        `${count(rows.length, 'figure')} of stats.json differ${rows.length === 1 ? 's' : ''}` :
        'All figures are the same',
    note: 'Only figures that differ are listed.',
    body: htmlTable(['figure', 'A', 'B', 'B − A'], rows.map(row => row.map(shortened))),
    numbers: () => [['figure', 'a', 'b', 'difference'], rows]
  });
}

// How the disparities of the runs differ.
function pixelText({pixels, no_pixels: reason}) {
  if (!pixels) return `not compared: ${reason}`;
  if (pixels.frames === 0) return 'not compared: no camera frame was computed by both runs';
  if (pixels.pixels === 0) return `the same, pixel for pixel, in ${count(pixels.frames, 'frame')}`;
  return `${whole(pixels.pixels)} differ, in ${pixels.frames_that_differ} of ${
             count(pixels.frames, 'frame')}; the first ` +
      `in column ${pixels.first.column}, row ${pixels.first.row} of camera frame ${
             pixels.first.camera_frame}`;
}

// What was changed, and what it does to the rate that both runs have.
function headlineOfTwo(a, b, settings) {
  const [ratesA, ratesB] = [a, b].map(run => run.stats.frames_per_second);
  const [name, kind] = kindOfRate(a, b);
  const [before, after] = [ratesA[name], ratesB[name]];
  const [openA, openB] = [ratesA, ratesB].map(rates => rates[`${name}_uncertainty`] ?? 0);
  const isTie = Math.abs(after - before) <= openA + openB;
  const change = settings.length === 0 ?
      'The same board' :
      changeText(settings[0]) + (settings.length > 1 ? ` and ${settings.length - 1} more` : '');
  return `${change}: ${isTie ? '≈ 0' : gainText(after / before - 1)}, from ${rateWith(before, openA)} to ${
      rateWith(after, openB)} frames/s, ${kind}`;
}

const changeText = ([key, x, y]) => `${key}: ${x} → ${y}`;

export function showTwoRuns(page, {runs: [a, b], difference}) {
  const [rateA, rateB] = [rateOf(a), rateOf(b)];
  const settings = settingsThatDiffer(a, b);
  const isSame = difference.pixels?.frames > 0 && difference.pixels.pixels === 0;
  const blame = run => waitsOf(run).length ? `${waitText(waitsOf(run)[0])}.` : 'Nobody.';
  addHead(page, {
    kind: 'two runs',
    name: `A ${a.folder} · B ${b.folder}`,
    headline: headlineOfTwo(a, b, settings),
    sub: [commandLine(a.command), commandLine(b.command)]
  });
  const {rows} = difference;
  addAnswers(page, [
    [
      'What was changed?',
      settings.length ? settings.slice(0, 4)
                            .map(changeText)
                            .concat(settings.length > 4 ? `and ${settings.length - 4} more` : []) :
                                                          ['Nothing on the board.']
    ],
    [
      'Which is faster, and why?',
      [grouped(difference.verdict), !isSame && `Disparities: ${pixelText(difference)}.`]
    ],
    ['Who waits for whom?', [`A: ${blame(a)}`, `B: ${blame(b)}`]],
    [
      'Where do they part?',
      [!rows ? `Rows cannot be compared: ${difference.no_rows}.` :
           rows.parting ? `In frame ${rows.parting.frame}, row ${rows.parting.row}.` :
                          'Nowhere.']
    ],
    [
      'What limits?',
      [
        `A: ${resourceText(rateA.by)}, at ${rate(rateA.limit)} frames/s.`,
        `B: ${resourceText(rateB.by)}, at ${rate(rateB.limit)} frames/s.`
      ]
    ]
  ]);

  const where = addGroup(page, 'Where and when');
  addRowDifference(where, difference);
  if (a.pictures && b.pictures) {
    addPicture(where, {
      title: `Disparities of A and B: ${pixelText(difference)}`,
      note: (difference.camera_frame === undefined ?
                 'The last frame of each run, because no camera frame was computed by both.' :
                 `Camera frame ${difference.camera_frame} in both.`) +
          ' With the rows that take longer in B.',
      pictures: [a, b].map(({pictures: {disparity, disparities}}) => ({url: disparity, disparities})),
      names: ['A', 'B'],
      frames: rows?.frames,
      layers: rows?.cycles.some(value => value > 0) ? [{
        name: 'B, by row',
        values: rows.cycles,
        columns: 1,
        rows: rows.cycles.length,
        width: settingOf(b, 'image.width'),
        height: 1
      }] :
                                                      []
    });
  }
  addFrames(
      where, [['A', a.stats.frame_cycles, '--blue'], ['B', b.stats.frame_cycles, '--vermilion']],
      settingOf(a, 'fpga.clock_mhz'));
  addBlameDifference(where, a, b);
  addMemoryOfTwo(where, a, b);

  const ports = addGroup(page, 'The ports');
  addPortStates(ports, a, 'A');
  addPortStates(ports, b, 'B');
  const figures = addGroup(page, 'The figures');
  addChart(figures, {
    id: 'settings',
    title: settings.length ?
        `${count(settings.length, 'key')} of the board differ${settings.length === 1 ? 's' : ''}` :
        'The boards are the same',
    body: h('div', null, settings.length > 0 && htmlTable(['key', 'A', 'B'], settings)),
    numbers: () => [['key', 'a', 'b'], settings]
  });
  addTotals(figures, a, b);
}
