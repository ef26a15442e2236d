// The cycles of each frame.
import {addChart, drawing, legend} from './chart.js';
import {s} from './dom.js';
import {whole} from './format.js';
import {axisLeft, linear} from './scale.js';
import {mark} from './tooltip.js';

const kMostBars = 200;

// series: [[name, [cycles, ..], colour], ..]
export function addFrames(page, series, clockMhz) {
  const frames = Math.max(...series.map(([, cycles]) => cycles.length));
  const all = series.flatMap(([, cycles]) => cycles);
  const [least, most] = [all.reduce((a, b) => Math.min(a, b)), all.reduce((a, b) => Math.max(a, b))];
  const shown = Math.min(frames, kMostBars);
  const draw = (host, width) => {
    const {plot, width: inner, height} =
        drawing(host, width, 220, {left: 48, right: 8, top: 22, bottom: 26}, 'Cycles of each frame');
    const y = linear([0, most * 1.05], [height, 0]);
    const step = inner / shown;
    const bar = Math.max(0.8, Math.min(40, (step - (step > 4 ? 2 : 0)) / series.length));
    plot.append(axisLeft(y, inner, height, 'cycles'));
    for (let frame = 0; frame < shown; ++frame) {
      series.forEach(([name, cycles, colour], i) => {
        if (cycles[frame] === undefined) return;
        plot.append(mark(
            s('rect', {
              x: frame * step + (step - bar * series.length) / 2 + i * bar,
              y: y(cycles[frame]),
              width: bar,
              height: height - y(cycles[frame]),
              style: `fill:var(${colour})`
            }),
            [
              `${name ? `${name}, ` : ''}frame ${frame}: ${whole(cycles[frame])} cycles`,
              `${(cycles[frame] / clockMhz / 1000).toFixed(3)} ms`
            ]));
      });
    }
    plot.append(
        s('line', {x1: 0, x2: inner, y1: height, y2: height, class: 'base'}),
        s('text', {x: inner, y: height + 18, 'text-anchor': 'end', class: 'label'},
          `frame 0 to ${shown - 1}${shown < frames ? ` of ${whole(frames)}` : ''}`));
  };
  addChart(page, {
    id: 'frames',
    draw,
    title: least === most ?
        `${frames === 1 ? 'The frame' : `Each of ${frames} frames`} takes ${whole(least)} cycles` :
        `Frames take ${whole(least)} to ${whole(most)} cycles`,
    note: 'Cycles of the FPGA clock from the start of a frame to its last result.',
    body: series.length > 1 && legend(series.map(([name, , colour]) => [name, `var(${colour})`])),
    numbers: () => [
        ['frame', ...series.map(([name]) => name || 'cycles')],
        Array.from(
            {length: frames}, (_, frame) => [frame, ...series.map(([, cycles]) => cycles[frame] ?? null)])]
  });
}
