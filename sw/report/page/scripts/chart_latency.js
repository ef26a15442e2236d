// From the first pixel of a capture to the results on the host: how long, and what of it is waiting.
import {addChart, drawing, legend} from './chart.js';
import {s} from './dom.js';
import {count, fixed, kPsOfMs, percent} from './format.js';
import {axisBelow, axisLeft, linear} from './scale.js';
import {Table} from './table.js';
import {mark} from './tooltip.js';

// Columns of latency.csv that are parts of it. The second of each is shown with the first.
const kParts = [
  [['capture_ps'], 'capture', '--blue'],
  [['wait_copy_ps'], 'waiting for the copy', '--pale'],
  [['copy_ps'], 'copy to the board', '--sky'],
  [['wait_core_ps'], 'waiting for the core', '--pale-blue'],
  [['core_ps'], 'core', '--vermilion'],
  [['wait_read_back_ps'], 'waiting for the read-back', '--faint'],
  [['read_back_ps', 'delivery_ps'], 'read-back', '--green'],
];
const kWaitParts = ['wait_copy_ps', 'wait_core_ps', 'wait_read_back_ps'];

function addPercentiles(page, latency) {
  const points = ['min', 'p50', 'p95', 'p99', 'max'].map(name => ({name, ms: latency[name]}));
  const draw = (host, width) => {
    const {plot, width: inner, height} =
        drawing(host, width, 110, {left: 20, right: 20, top: 34, bottom: 40}, 'Latency');
    const x = linear([0, latency.max * 1.05], [0, inner]);
    plot.append(
        axisBelow(x, inner, height, 'ms'),
        s('line', {x1: x(latency.min), x2: x(latency.max), y1: 14, y2: 14, class: 'stem'}));
    let end = -Infinity;
    for (const {name, ms} of points) {
      plot.append(mark(
          s('circle', {cx: x(ms), cy: 14, r: name === 'p50' ? 7 : 5, style: 'fill:var(--blue)'}),
          [`${name}: ${fixed(ms, 3)} ms`]));
      if (x(ms) - end < 40) continue;
      plot.append(s('text', {x: x(ms), y: -6, 'text-anchor': 'middle'}, `${name} ${fixed(ms, 0)}`));
      end = x(ms);
    }
  };
  addChart(page, {
    id: 'latency',
    wide: true,
    draw,
    title: `Half of the results are ${fixed(latency.p50, 1)} ms old when they arrive, the oldest ${
        fixed(latency.max, 1)} ms`,
    note:
        'From the first pixel of a capture to the results on the host. What of it is waiting was left out ' +
        'by --quick, because the run was not recorded.',
    numbers: () => [['percentile', 'ms'], points.map(({name, ms}) => [name, ms])]
  });
}

export function addLatency(page, run) {
  const percentiles = run.stats.latency_ms?.capture_to_host;
  if (!percentiles) return;
  if (!run.recording) return addPercentiles(page, percentiles);
  const {rows, all, means_ps: means, columns} = run.recording.latency;
  const table = new Table(columns, rows);
  const inMs = name => table.column(name).map(ps => ps / kPsOfMs);
  const parts =
      kParts.filter(([names]) => names.some(name => means[name] > 0)).map(([names, text, colour]) => {
        const all = names.map(inMs);
        return {text, colour, ms: all[0].map((_, i) => all.reduce((sum, values) => sum + values[i], 0))};
      });
  const [frame, total] = [table.column('frame'), inMs('latency_ps')];
  const share = kWaitParts.reduce((sum, name) => sum + means[name], 0) / means.latency_ps;
  const draw = (host, width) => {
    const {plot, width: inner, height} =
        drawing(host, width, 280, {left: 44, right: 8, top: 22, bottom: 34}, 'Latency of each frame');
    const y = linear([0, total[rows - 1] * 1.05], [height, 0]);
    const step = inner / rows;
    plot.append(axisLeft(y, inner, height, 'ms'));
    for (let i = 0; i < rows; ++i) {
      const bar = s('g');
      let from = 0;
      for (const {colour, ms} of parts) {
        bar.append(s('rect', {
          x: i * step,
          y: y(from + ms[i]),
          width: Math.max(0.6, step > 4 ? step - 1 : step),
          height: Math.max(0, y(from) - y(from + ms[i])),
          style: `fill:var(${colour})`
        }));
        from += ms[i];
      }
      plot.append(mark(bar, [
        `frame ${frame[i]}: ${fixed(total[i], 3)} ms`,
        ...parts.map(({text, ms}) => `${text}: ${fixed(ms[i], 3)} ms`)
      ]));
    }
    plot.append(
        s('line', {x1: 0, x2: inner, y1: height, y2: height, class: 'base'}),
        s('text', {x: inner, y: height + 20, 'text-anchor': 'end', class: 'label'},
          `${rows < all ? `${count(rows, 'frame')} of ${all}` : count(rows, 'frame')}, the quickest first`));
  };
  addChart(page, {
    id: 'latency',
    wide: true,
    draw,
    title: `Of the mean ${fixed(means.latency_ps / kPsOfMs, 1)} ms from capture to host, ${
        percent(share, 0)} is waiting`,
    note:
        'One bar for each delivered frame, from the first pixel of the capture to the results on the host. ' +
        `Half of the frames take at most ${fixed(percentiles.p50, 1)} ms, 95 % at most ${
            fixed(percentiles.p95, 1)}, the slowest ${fixed(percentiles.max, 1)}.`,
    body: legend(parts.map(({text, colour}) => [text, `var(${colour})`])),
    numbers: () =>
        [table.names, Array.from({length: rows}, (_, i) => table.names.map(name => table.column(name)[i]))]
  });
}
