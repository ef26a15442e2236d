// The time line of the computer: captures, uploads, frames of the core, read-backs, drops.
import {addBrush} from './brush.js';
import {addChart, cut, drawing, legend} from './chart.js';
import {h, s} from './dom.js';
import {fixed, whole} from './format.js';
import {axisBelow, linear} from './scale.js';
import {Table} from './table.js';
import {mark} from './tooltip.js';

const kKinds = {
  capture: '--blue',
  upload: '--sky',
  core: '--vermilion',
  'read-back': '--green',
  drop: '--grey',
  interrupt: '--purple'
};
const kFirstFrames = 8;
const kMostMarks = 1500;

const inMs = us => us / 1000;

export function addTimeLine(page, run, absent) {
  const events = run.recording?.events;
  if (!events) return absent(page, 'time', 'Time line of captures, core and read-backs');
  const table = new Table(events.columns, events.rows);
  const [lane, kind, frame, start, end, waited, why] =
      ['lane', 'kind', 'frame', 'start_us', 'end_us', 'waited_us', 'why'].map(name => table.column(name));
  const lanes = [...new Set(lane)];
  const last = Math.max(...end);
  const drops = kind.filter(each => each === 'drop').length;
  const begin = Math.min(...start.filter((_, i) => kind[i] === 'capture'), last);
  const early = Math.max(...end.filter((_, i) => frame[i] < kFirstFrames), 1);
  const state = {from: Math.min(begin, early), to: early};
  const draw = (host, width) => {
    const left = Math.min(100, width * 0.26);
    const {plot, width: inner, height} =
        drawing(host, width, lanes.length * 34 + 50, {left, right: 8, top: 6, bottom: 40}, 'Time line');
    const x = linear([inMs(state.from), inMs(state.to)], [0, inner]);
    plot.append(axisBelow(
        x, inner, height, 'ms since power-up',
        {text: tick => fixed(tick, state.to - state.from < 20000 ? 2 : 0)}));
    addBrush(plot, {
      axis: 'x',
      width: inner,
      height,
      end: box => box && zoom(1000 * x.invert(box.x0), 1000 * x.invert(box.x1))
    });
    lanes.forEach(
        (name, line) =>
            plot.append(s('text', {x: -8, y: line * 34 + 21, 'text-anchor': 'end'}, cut(name, left - 8))));
    let marks = 0;
    for (let i = 0; i < events.rows && marks < kMostMarks; ++i) {
      if (end[i] < state.from || start[i] - waited[i] > state.to) continue;
      ++marks;
      const y = lanes.indexOf(lane[i]) * 34;
      const at = us => Math.max(0, Math.min(inner, x(inMs(us))));
      const [x0, x1] = [at(start[i]), at(end[i])];
      if (waited[i] > 0)
        plot.append(s('rect', {
          x: at(start[i] - waited[i]),
          y: y + 13,
          width: Math.max(0.5, x0 - at(start[i] - waited[i])),
          height: 8,
          class: 'waiting'
        }));
      const lines = [
        `${kind[i]}${frame[i] >= 0 ? ` of frame ${frame[i]}` : ''}: ${fixed(inMs(start[i]), 3)} to ${
            fixed(inMs(end[i]), 3)} ms`,
        end[i] > start[i] && `takes ${fixed(inMs(end[i] - start[i]), 3)} ms`,
        waited[i] > 0 && `waited ${fixed(inMs(waited[i]), 3)} ms`, why[i] || null
      ].filter(Boolean);
      const shape = end[i] > start[i] ?
          s('rect', {x: x0, y: y + 7, width: Math.max(1.5, x1 - x0), height: 20, rx: 2}) :
          s('path', {d: `M${x0 - 5},${y + 12}l10,10m0,-10l-10,10`, class: 'cross'});
      shape.setAttribute(
          'style', `${end[i] > start[i] ? 'fill' : 'stroke'}:var(${kKinds[kind[i]] ?? '--grey'})`);
      plot.append(mark(shape, lines));
      if (frame[i] >= 0 && x1 - x0 > 26)
        plot.append(
            s('text', {x: (x0 + x1) / 2, y: y + 21, 'text-anchor': 'middle', class: 'on-bar'},
              String(frame[i])));
    }
    if (marks === kMostMarks)
      plot.append(
          s('text', {x: inner, y: 4, 'text-anchor': 'end', class: 'label'},
            `the first ${whole(marks)} are drawn: zoom in`));
  };
  const zoom = (from, to) => {
    const size = Math.max(10, Math.min(last, to - from));
    state.from = Math.max(0, Math.min(last - size, from));
    state.to = state.from + size;
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
  const kinds = Object.entries(kKinds).filter(([name]) => kind.includes(name));
  const core = kind.map((each, i) => each === 'core' ? end[i] - start[i] : 0).reduce((a, b) => a + b, 0);
  const chart = addChart(page, {
    id: 'time',
    wide: true,
    draw,
    title: `The core works ${fixed(100 * core / last, 1)} % of the time${
        drops ? `; ${whole(drops)} camera frames are dropped` : ''}`,
    note:
        'The number in a bar is the frame; the thin bar before it the time that it waited. Drag to zoom in.',
    body: [
      h('div', {class: 'controls'}, button('+', 'Zoom in', 0.25, -0.25), button('−', 'Zoom out', -0.5, 0.5),
        button('◀', 'Earlier', -0.5, -0.5), button('▶', 'Later', 0.5, 0.5),
        h('button', {type: 'button', class: 'small', click: () => zoom(0, last)}, 'All')),
      legend(kinds.map(([name, colour]) => [name, `var(${colour})`]))
    ],
    numbers: () =>
        [table.names,
         Array.from({length: events.rows}, (_, i) => table.names.map(name => table.column(name)[i]))]
  });
}
