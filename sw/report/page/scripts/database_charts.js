// The chart of a database: any two of its columns with the front of Pareto.
import {addChart, legend} from './card.js';
import {checkBox, choice, controls, h, s} from './dom.js';
import {count, different, least, most, value, whole} from './format.js';
import {addBrush, axisBelow, axisLeft, layeredDrawing, numeric, ordinal} from './plot.js';
import {kRateColumns} from './points.js';
import {nthColour, styleColour} from './theme.js';
import {linkMarks, mark} from './tooltip.js';

const kMostColours = 8;  // values of a key that have a colour each
const kReach = 14;       // pixels from the pointer to the point that it means

// The scale of a column, and the place of each point on it, NaN without a value. A column of words has its
// different values at equal distances.
function placesOf(points, name, range, isLog) {
  const kRoom = 0.03;  // of the range, on either side
  const values = points.column(name);
  const placed = (scale, valueOf) =>
      ({scale, at: Float32Array.from(values, each => each === null ? NaN : scale(valueOf(each)))});
  if (!points.isNumeric(name)) return placed(ordinal(different(values).map(value), range), value);
  const numbers = values.filter(each => each !== null);
  const [low, high] = [least(numbers), most(numbers)];
  const margin = (high - low) * kRoom;
  const scale = isLog && low > 0 ? numeric([low / 1.05, high * 1.05], range, true) :
                                   numeric([low - margin, high + margin], range);
  return placed(scale, each => each);
}

// The line around what a front beats, from the best x on: steps between its points, and on to the edges of
// the drawing. `spots`: places of the points; `edges`: the worst x and y.
function stepsOf(spots, edges) {
  if (spots.length === 0) return [];
  const worse = edges.map(edge => edge === 0 ? Math.min : Math.max);
  return spots
      .flatMap((spot, i) => {
        const before = spots[i - 1] ?? [spot[0], edges[1]];
        return [worse.map((worst, axis) => worst(before[axis], spot[axis])), spot];
      })
      .concat([[edges[0], spots.at(-1)[1]]]);
}

// The colour of each point, by the first key with few values: [function of a row, entries of the legend].
function coloursOf(points) {
  const key = points.keys.find(each => new Set(points.column(each)).size <= kMostColours);
  if (!key) return [() => styleColour('--blue'), []];
  const values = points.column(key);
  const colours = new Map(different(values).map((word, i) => [word, styleColour(nthColour(i))]));
  const entries = [...colours].map(([word, colour]) => [`${key} ${value(word)}`, colour]);
  return [row => colours.get(values[row]), entries];
}

// Any two columns: points on a canvas, below axes and the front of Pareto in SVG.
export function addScatter(page, points, choose) {
  const numbers = points.names.filter(name => points.isNumeric(name));
  const y = {
    id: 'y',
    name: kRateColumns.find(name => points.figures.includes(name)) ?? numbers[0],
    best: 'max'
  };
  const other = numbers.find(name => name !== y.name) ?? y.name;
  const x = {id: 'x', name: points.figures.includes('area.slices') ? 'area.slices' : other, best: 'min'};
  let repaint = () => {};
  const frontText = h('p', {class: 'note', id: 'front-text'});
  const legendHost = h('div');
  const linesOf =
      row => [y.name, x.name]
                 .map(name => `${name} ${value(points.column(name)[row])}`)
                 .concat(points.keys.slice(0, 8).map(key => `${key}: ${value(points.column(key)[row])}`));

  const draw = (host, width) => {
    const total = Math.min(640, Math.max(320, width * 0.62));
    const {plot, width: inner, height, context, clear} =
        layeredDrawing(host, width, total, {left: 64, right: 14, top: 26, bottom: 44}, 'Points');
    const [across, up] = [[x, [0, inner]], [y, [height, 0]]].map(
        ([axis, range]) => placesOf(points, axis.name, range, axis.log));
    const spot = row => [across.at[row], up.at[row]];
    const [colourOf, entries] = coloursOf(points);
    const faint = styleColour('--faint');
    legendHost.replaceChildren(legend(entries));
    const size = points.size > 3000 ? 3 : 5;
    const frontLayer = s('g');
    repaint = () => {
      clear();
      for (const wanted of [0, 1]) {
        points.selected.forEach((is, row) => {
          if (is !== wanted) return;
          context.fillStyle = is ? colourOf(row) : faint;
          context.fillRect(across.at[row] - size / 2, up.at[row] - size / 2, size, size);
        });
      }
      const front = points.isNumeric(x.name) && points.isNumeric(y.name) ? points.front(x, y) : [];
      const edges = [x.best === 'min' ? inner : 0, y.best === 'min' ? 0 : height];
      const dot = (row, attributes) => s('circle', {cx: across.at[row], cy: up.at[row], ...attributes});
      const spots = front.map(row => {
        const go = event => (event.type === 'click' || event.key === 'Enter') && choose(row);
        return mark(dot(row, {r: 5, class: 'on-front', click: go, keydown: go}), linesOf(row));
      });
      frontLayer.replaceChildren(
          s('polyline', {class: 'front', points: stepsOf(front.map(spot), edges).join(' ')}), ...spots,
          ...points.chosen >= 0 ? [dot(points.chosen, {r: 9, class: 'chosen'})] : []);
      linkMarks(host);
      const ties = [x, y].some(({name}) => points.hasUncertainty(name));
      frontText.textContent = `${count(points.count, 'point')} of ${whole(points.size)} selected; ${
          whole(front.length)} of them on the front.${ties ? ' What lies within the uncertainty ties.' : ''}`;
    };
    const select = box =>
        points.filter('scatter', box && (row => {
                                   const [px, py] = spot(row);
                                   return px >= box.x0 && px <= box.x1 && py >= box.y0 && py <= box.y1;
                                 }));
    const nearest = place => {
      let found = -1;
      let best = kReach * kReach;
      for (let row = 0; row < points.size; ++row) {
        const far = (across.at[row] - place.x) ** 2 + (up.at[row] - place.y) ** 2;
        if (far < best && points.selected[row]) [found, best] = [row, far];
      }
      return found;
    };
    plot.append(
        axisBelow(across.scale, inner, height, x.name), axisLeft(up.scale, inner, height, ''),
        s('text', {x: -60, y: -12, class: 'label left'}, y.name));
    addBrush(plot, {
      axis: 'xy',
      width: inner,
      height,
      change: select,
      end: (box, place) => {
        const row = box ? -1 : nearest(place);
        if (row >= 0)
          choose(row);
        else if (box || points.filters.has('scatter'))
          select(box);
      },
      tip: place => {
        const row = nearest(place);
        return row >= 0 ? linesOf(row) : null;
      }
    });
    plot.append(frontLayer);
    repaint();
  };
  const pick = (id, label, chosen, names, change) =>
      h('label', null, `${label} `,
        choice(id, names.map(name => [name, name]), chosen, name => {
          change(name);
          points.filter('scatter', null);
          chart.redraw();
        }));
  const pickAxis = axis => controls(
      pick(`scatter-${axis.id}`, axis.id, axis.name, points.names, name => Object.assign(axis, {name})),
      pick(`best-${axis.id}`, 'better:', axis.best, ['min', 'max'], best => Object.assign(axis, {best})),
      checkBox(`log-${axis.id}`, 'log', log => {
        axis.log = log;
        chart.redraw();
      }));
  const chart = addChart(page, {
    id: 'scatter',
    wide: true,
    title: 'Two columns, and the points that no other beats',
    draw,
    body: [pickAxis(x), pickAxis(y), legendHost, frontText],
    note:
        'Drag to select points, click one for its board. Arrow keys go along the front, Enter opens a point.',
    numbers: () => points.numbers([...new Set([x.name, y.name, ...points.keys])], points.front(x, y))
  });
  points.whenSelected(() => repaint());
  return {redraw: () => repaint()};
}
