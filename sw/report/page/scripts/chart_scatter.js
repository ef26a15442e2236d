// Any two columns of a database: points on a canvas, below axes and the front of Pareto in SVG.
import {addBrush} from './brush.js';
import {addChart, canvasOf, drawing, legend} from './chart.js';
import {h, s} from './dom.js';
import {count, value, whole} from './format.js';
import {kRateColumns} from './points.js';
import {axisBelow, axisLeft} from './scale.js';
import {coloursOf, kMostColours, scaleOf, stepsOf} from './scatter_parts.js';
import {styleColour} from './theme.js';
import {hideTooltip, linkMarks, mark, showTooltip} from './tooltip.js';

const kMargins = {
  left: 64,
  right: 14,
  top: 26,
  bottom: 44
};
const kReach = 14;  // pixels from the pointer to the point that it means

export function addScatter(page, points, {choose}) {
  const numeric = points.names.filter(name => points.isNumeric(name));
  const y = {
    name: kRateColumns.find(name => points.figures.includes(name)) ?? numeric[0],
    best: 'max',
    log: false
  };
  const x = {
    name: points.figures.includes('area.slices') ? 'area.slices' :
                                                   numeric.find(name => name !== y.name) ?? y.name,
    best: 'min',
    log: false
  };
  const state = {colour: points.keys.find(key => new Set(points.column(key)).size <= kMostColours) ?? ''};
  let repaint = null;
  const note = h('p', {class: 'note', id: 'front-text'});
  const legendHost = h('div');

  const draw = (host, width) => {
    const total = Math.min(640, Math.max(320, width * 0.62));
    const {canvas, context} = canvasOf(width, total);
    canvas.style.cssText += ';position:absolute;left:0;top:0';
    host.classList.add('layered');
    host.append(canvas);
    const {plot, width: inner, height, svg} = drawing(host, width, total, kMargins, 'Points');
    svg.style.position = 'relative';
    const scales = [scaleOf(points, x, [0, inner]), scaleOf(points, y, [height, 0])];
    plot.append(
        axisBelow(scales[0], inner, height, x.name), axisLeft(scales[1], inner, height, ''),
        s('text', {x: -60, y: -12, class: 'label left'}, y.name));
    const place = points.column(x.name).map((_, row) => row);
    const at = [[x, 0], [y, 1]].map(([axis, i]) => {
      const values = points.column(axis.name);
      const offset = i === 0 ? kMargins.left : kMargins.top;
      const numericAxis = points.isNumeric(axis.name);
      return Float32Array.from(
          place,
          row => values[row] === null ? NaN :
                                        offset + scales[i](numericAxis ? values[row] : value(values[row])));
    });
    const [colourOf, entries] = coloursOf(points, state.colour);
    legendHost.replaceChildren(legend(entries));
    const colours = place.map(colourOf);
    const groups = new Map();
    colours.forEach((colour, row) => groups.get(colour)?.push(row) ?? groups.set(colour, [row]));
    const size = points.size > 3000 ? 3 : 5;
    const frontLayer = s('g');
    repaint = final => {
      context.clearRect(0, 0, width, total);
      context.fillStyle = styleColour('--faint');
      for (let row = 0; row < points.size; ++row) {
        if (!points.selected[row]) context.fillRect(at[0][row] - size / 2, at[1][row] - size / 2, size, size);
      }
      for (const [colour, rows] of groups) {
        context.fillStyle = colour;
        for (const row of rows) {
          if (points.selected[row])
            context.fillRect(at[0][row] - size / 2, at[1][row] - size / 2, size, size);
        }
      }
      if (final) drawFront();
    };
    const {area} = addBrush(plot, {
      axis: 'xy',
      width: inner,
      height,
      change: box => select(box, false),
      end: (box, event) => {
        if (box) return select(box, true);
        const row = nearest(event);
        if (row >= 0)
          choose(row);
        else if (points.filters.has('scatter'))
          points.filter('scatter', null);
      }
    });
    plot.append(frontLayer);
    const select = (box, final) => {
      if (!box) return points.filter('scatter', null, final);
      const [left, right] = [box.x0 + kMargins.left, box.x1 + kMargins.left];
      const [top, bottom] = [box.y0 + kMargins.top, box.y1 + kMargins.top];
      points.filter(
          'scatter',
          row => at[0][row] >= left && at[0][row] <= right && at[1][row] >= top && at[1][row] <= bottom,
          final);
    };
    const nearest = event => {
      const box = host.getBoundingClientRect();
      const [px, py] = [event.clientX - box.left, event.clientY - box.top];
      let found = -1;
      let best = kReach * kReach;
      for (let row = 0; row < points.size; ++row) {
        const far = (at[0][row] - px) ** 2 + (at[1][row] - py) ** 2;
        if (far < best && points.selected[row]) [found, best] = [row, far];
      }
      return found;
    };
    area.classList.add('hovers');
    area.addEventListener('pointermove', event => {
      if (event.buttons) return;
      const row = nearest(event);
      if (row >= 0)
        showTooltip(linesOf(row), event.clientX, event.clientY);
      else
        hideTooltip();
    });
    area.addEventListener('pointerleave', hideTooltip);
    const drawFront = () => {
      frontLayer.replaceChildren();
      const front = points.isNumeric(x.name) && points.isNumeric(y.name) ? points.front(x, y) : [];
      const spot = row => [at[0][row] - kMargins.left, at[1][row] - kMargins.top];
      const edges = [x.best === 'min' ? inner : 0, y.best === 'min' ? 0 : height];
      frontLayer.append(s('polyline', {class: 'front', points: stepsOf(front.map(spot), edges).join(' ')}));
      for (const row of front) {
        const [cx, cy] = spot(row);
        const go = event => (event.type === 'click' || event.key === 'Enter') && choose(row);
        frontLayer.append(
            mark(s('circle', {cx, cy, r: 5, class: 'on-front', click: go, keydown: go}), linesOf(row)));
      }
      if (points.chosen >= 0) {
        const [cx, cy] = spot(points.chosen);
        frontLayer.append(s('circle', {cx, cy, r: 9, class: 'chosen'}));
      }
      linkMarks(host);
      note.textContent = `${count(points.count, 'point')} of ${whole(points.size)} selected; ${
          whole(front.length)} of them on the front.${
              [x, y].some(({name}) => points.hasUncertainty(name)) ?
              ' What lies within the uncertainty ties.' :
              ''}`;
    };
    repaint(true);
  };
  const linesOf = row =>
      [`${y.name} ${value(points.column(y.name)[row])}`, `${x.name} ${value(points.column(x.name)[row])}`,
       ...points.keys.slice(0, 8).map(key => `${key}: ${value(points.column(key)[row])}`)];
  const pick = (id, label, chosen, names, change) =>
      h('label', null, `${label} `,
        h('select', {
          id,
          change: event => {
            change(event.target.value);
            points.filter('scatter', null);
            chart.redraw();
          }
        },
          names.map(name => h('option', {value: name, selected: name === chosen}, name || 'one colour'))));
  const bests = axis => pick(`best-${axis === x ? 'x' : 'y'}`, 'better:', axis.best, ['min', 'max'], best => {
    axis.best = best;
  });
  const log = axis =>
      h('label', {class: 'check'}, h('input', {
          type: 'checkbox',
          id: `log-${axis === x ? 'x' : 'y'}`,
          change: event => {
            axis.log = event.target.checked;
            chart.redraw();
          }
        }),
        ' log');
  const chart = addChart(page, {
    id: 'scatter',
    wide: true,
    title: 'Two columns, and the points that no other beats',
    draw,
    body: [
      h('div', {class: 'controls'},
        pick(
            'scatter-x', 'x', x.name, points.names,
            name => {
              x.name = name;
            }),
        bests(x), log(x)),
      h('div', {class: 'controls'},
        pick(
            'scatter-y', 'y', y.name, points.names,
            name => {
              y.name = name;
            }),
        bests(y), log(y)),
      h('div', {class: 'controls'},
        pick(
            'scatter-colour', 'colour', state.colour, ['', ...points.names],
            name => {
              state.colour = name;
            }),
        legendHost),
      note
    ],
    note:
        'Drag to select points, click one for its board. Arrow keys go along the front, Enter opens a point.',
    numbers: () => {
      const front = points.front(x, y);
      const names = [x.name, y.name, ...points.keys.filter(key => key !== x.name && key !== y.name)];
      return [names, front.map(row => names.map(name => points.column(name)[row]))];
    }
  });
  points.whenSelected(final => repaint?.(final));
  return {chart, axes: () => [x, y], redraw: () => repaint?.(true)};
}
