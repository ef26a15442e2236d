// Parallel coordinates: one axis for each column, one line for each point. Each axis can be brushed.
import {addBrush} from './brush.js';
import {addChart, canvasOf, cut, drawing} from './chart.js';
import {h, s} from './dom.js';
import {brief, value} from './format.js';
import {linear, ordinal} from './scale.js';
import {styleColour} from './theme.js';
import {mark} from './tooltip.js';

const kMostAxes = 9;
const kLinesWhileBrushing = 400;

// Rows in an order in which each first part is a fair sample.
function shuffledRows(size) {
  const rows = Uint32Array.from({length: size}, (_, row) => row);
  let state = 1;
  for (let i = size - 1; i > 0; --i) {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    const other = state % (i + 1);
    [rows[i], rows[other]] = [rows[other], rows[i]];
  }
  return rows;
}

export function addParallel(page, points) {
  const defaults = [...points.keys.slice(0, kMostAxes - 2), ...points.figures.slice(0, 2)];
  const state = {names: defaults};
  const order = shuffledRows(points.size);
  let repaint = null;
  const draw = (host, width) => {
    const height = 330;
    const margins = {left: 34, right: 34, top: 48, bottom: 14};
    const few = state.names.slice(0, Math.max(3, Math.floor(width / 85)));
    const {canvas, context} = canvasOf(width, height);
    canvas.style.cssText += ';position:absolute;left:0;top:0';
    host.classList.add('layered');
    host.append(canvas);
    const {plot, width: inner, height: tall, svg} =
        drawing(host, width, height, margins, 'Parallel coordinates');
    svg.style.position = 'relative';
    const step = inner / Math.max(1, few.length - 1);
    const axes = few.map((name, i) => {
      const values = points.column(name);
      const isNumeric = points.isNumeric(name) && new Set(values).size > 12;
      const numbers = isNumeric ? values.filter(each => each !== null) : [];
      const words = [...new Set(values)]
                        .sort((a, b) => typeof a === 'number' ? a - b : value(a).localeCompare(value(b)))
                        .map(value);
      const scale = isNumeric ?
          linear(
              [numbers.reduce((a, b) => Math.min(a, b)), numbers.reduce((a, b) => Math.max(a, b))],
              [tall, 0]) :
          ordinal(words, [tall, 0]);
      return {
        name,
        x: i * step,
        scale,
        isNumeric,
        values,
        at: Float32Array.from(values, each => each === null ? NaN : scale(isNumeric ? each : value(each)))
      };
    });
    const lines = (colour, most, wanted) => {
      context.strokeStyle = colour;
      context.beginPath();
      let drawn = 0;
      for (const row of order) {
        if (points.selected[row] !== wanted) continue;
        if (++drawn > most) break;
        axes.forEach(
            ({x, at}, i) => i === 0 ? context.moveTo(margins.left + x, margins.top + at[row]) :
                                      context.lineTo(margins.left + x, margins.top + at[row]));
      }
      context.stroke();
    };
    repaint = final => {
      context.clearRect(0, 0, width, height);
      context.lineWidth = 1;
      const selected = points.count;
      context.globalAlpha = 0.25;
      lines(styleColour('--faint'), final ? 800 : 100, 0);
      context.globalAlpha = Math.max(0.06, Math.min(0.7, 60 / Math.max(1, selected)));
      lines(styleColour('--blue'), final ? 4000 : kLinesWhileBrushing, 1);
      context.globalAlpha = 1;
    };
    axes.forEach(({name, x, scale, isNumeric, values}, i) => {
      const group = s('g', {transform: `translate(${x} 0)`});
      const anchor = i === 0 && few.length > 1 ? 'start' : i === few.length - 1 ? 'end' : 'middle';
      const shift = i === 0 ? -30 : i === few.length - 1 ? 30 : 0;
      const [head, ...tail] = name.split('.');
      group.append(
          s('line', {y1: 0, y2: tall, class: 'base'}),
          mark(
              s('rect',
                {x: -step / 2 + 2, y: -46, width: Math.max(10, step - 4), height: 34, class: 'reach'}),
              [name, 'Drag along the axis to select']),
          s('text', {x: shift, y: -30, 'text-anchor': anchor, class: 'label'},
            cut(tail.length ? head : '', step)),
          s('text', {x: shift, y: -17, 'text-anchor': anchor},
            cut(tail.length ? tail.join('.') : head, step)));
      let lastY = Infinity;
      const ticks = isNumeric ? scale.ticks(5) : scale.ticks();
      const end = i === axes.length - 1;
      for (const tick of ticks) {
        const y = scale(tick);
        if (lastY - y < 12) continue;
        lastY = y;
        group.append(
            s('text', {x: end ? -4 : 4, y: y + 4, 'text-anchor': end ? 'end' : 'start', class: 'tick halo'},
              cut(isNumeric ? brief(tick) : tick, step * 0.8)));
      }
      const set = (box, final) => points.filter(
          `axis ${name}`, box && (row => {
                            const y = scale(isNumeric ? values[row] : value(values[row]));
                            return y >= box.y0 && y <= box.y1;
                          }),
          final);
      const strip = s('g', {transform: 'translate(-14 0)'});
      addBrush(
          strip,
          {axis: 'y', width: 28, height: tall, change: box => set(box, false), end: box => set(box, true)});
      group.append(strip);
      plot.append(group);
    });
    for (const name of [...points.filters.keys()].filter(each => each.startsWith('axis ')))
      points.filters.delete(name);
    repaint(true);
  };
  const add =
      h('select', {
        id: 'parallel-axes',
        multiple: true,
        size: 6,
        change: event => {
          state.names = [...event.target.selectedOptions].map(option => option.value);
          chart.redraw();
          points.filter('parallel', null);
        }
      },
        points.names.map(name => h('option', {value: name, selected: defaults.includes(name)}, name)));
  const chart = addChart(page, {
    id: 'parallel',
    wide: true,
    draw,
    title: `${points.keys.length} keys vary`,
    note: 'One line for each selected point, at most 4000. Drag along an axis to select; click it to clear.',
    body:
        h('details', null, h('summary', null, 'Axes'),
          h('p', {class: 'note'}, 'Ctrl-click takes or leaves an axis.'), add),
    numbers: () =>
        [state.names,
         Array.from({length: points.size}, (_, row) => row)
             .filter(row => points.selected[row])
             .map(row => state.names.map(name => points.column(name)[row]))]
  });
  // In one frame of the screen at most one picture, whatever moves the brush.
  let waiting = false;
  let lastFinal = true;
  points.whenSelected(final => {
    lastFinal = final;
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      repaint?.(lastFinal);
    });
  });
  return chart;
}
