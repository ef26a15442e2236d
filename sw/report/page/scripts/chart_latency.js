// From the first pixel of a capture to the results on the host: how long, and what of it is waiting.
import {addChart, drawing, legend} from './chart.js';
import {s} from './dom.js';
import {count, fixed, percent} from './format.js';
import {axisBelow, axisLeft, linear} from './scale.js';
import {Table} from './table.js';
import {mark} from './tooltip.js';

const kParts = [
  ['capture_ms', 'capture', '--blue'], ['wait_for_core_ms', 'waiting for the core', '--pale-blue'],
  ['core_ms', 'core', '--vermilion'], ['wait_for_read_back_ms', 'waiting for the read-back', '--pale'],
  ['read_back_ms', 'read-back', '--green']
];

function addPercentiles(page, latency, absent) {
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
    note: `From the first pixel of a capture to the results on the host. ${absent}`,
    numbers: () => [['percentile', 'ms'], points.map(({name, ms}) => [name, ms])]
  });
}

export function addLatency(page, run, absentText) {
  const latency = run.stats.latency_ms?.capture_to_host;
  if (!latency) return;
  const recorded = run.recording?.latency;
  if (!recorded) return addPercentiles(page, latency, absentText);
  const table = new Table(recorded.columns, recorded.rows);
  const parts = kParts.map(([name]) => table.column(name));
  const frame = table.column('frame');
  const total = frame.map((_, i) => parts.reduce((all, part) => all + part[i], 0));
  const order = frame.map((_, i) => i).sort((a, b) => total[a] - total[b]);
  const mean = part => part.reduce((a, b) => a + b, 0) / frame.length;
  const waiting = (mean(parts[1]) + mean(parts[3])) / mean(total);
  const draw = (host, width) => {
    const {plot, width: inner, height} =
        drawing(host, width, 280, {left: 44, right: 8, top: 22, bottom: 34}, 'Latency of each frame');
    const y = linear([0, Math.max(...total) * 1.05], [height, 0]);
    const step = inner / order.length;
    plot.append(axisLeft(y, inner, height, 'ms'));
    order.forEach((i, place) => {
      const bar = s('g');
      let from = 0;
      kParts.forEach(([, , colour], part) => {
        const to = from + parts[part][i];
        bar.append(s('rect', {
          x: place * step,
          y: y(to),
          width: Math.max(0.6, step > 4 ? step - 1 : step),
          height: Math.max(0, y(from) - y(to)),
          style: `fill:var(${colour})`
        }));
        from = to;
      });
      plot.append(mark(bar, [
        `frame ${frame[i]}: ${fixed(total[i], 3)} ms`,
        ...kParts.map(([, name], part) => `${name}: ${fixed(parts[part][i], 3)} ms`)
      ]));
    });
    plot.append(
        s('line', {x1: 0, x2: inner, y1: height, y2: height, class: 'base'}),
        s('text', {x: inner, y: height + 20, 'text-anchor': 'end', class: 'label'},
          `${count(order.length, 'frame')}, the quickest first`));
  };
  addChart(page, {
    id: 'latency',
    wide: true,
    draw,
    title: `${percent(waiting, 0)} of the ${fixed(mean(total), 1)} ms from capture to host are waiting`,
    note: 'One bar for each delivered frame, from the first pixel of the capture to the results on the host.',
    body: legend(kParts.map(([, name, colour]) => [name, `var(${colour})`])),
    numbers: () => [
        ['frame', ...kParts.map(([name]) => name)],
        frame.map((number, i) => [number, ...parts.map(part => part[i])])]
  });
}
