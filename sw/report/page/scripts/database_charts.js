// The charts of a database: any two of its columns with the front of Pareto, and parallel coordinates.
import {addChart, legend} from './card.js';
import {checkBox, choice, controls, folded, h, note, s} from './dom.js';
import {brief, count, different, least, most, value, varyText, whole} from './format.js';
import {addBrush, axisBelow, axisLeft, cut, layeredDrawing, numeric, ordinal} from './plot.js';
import {kRateColumns} from './points.js';
import {css, heat, nthColour, styleColour} from './theme.js';
import {linkMarks, mark} from './tooltip.js';

const kMostColours = 8;  // names with a colour of their own
const kReach = 14;       // pixels from the pointer to the point that it means

// The scale of a column, and the place of each point on it, NaN without a value. A column of texts, or of at
// most `mostWords` different numbers, has its values at equal distances. `room`: margin on either side, as a
// share of the difference of largest and smallest value; a logarithmic scale has a margin of its own.
function placesOf(points, name, range, {isLog = false, room = 0, mostWords = 0} = {}) {
  const values = points.column(name);
  const isNumeric = points.isNumeric(name) && (mostWords === 0 || new Set(values).size > mostWords);
  const placed = (scale, valueOf) =>
      ({scale, isNumeric, at: Float32Array.from(values, each => each === null ? NaN : scale(valueOf(each)))});
  if (!isNumeric) return placed(ordinal(different(values).map(value), range), value);
  const numbers = values.filter(each => each !== null);
  const [low, high] = [least(numbers), most(numbers)];
  const margin = (high - low) * room;
  const scale = isLog && low > 0 ? numeric([low / 1.05, high * 1.05], range, true) :
                                   numeric([low - margin, high + margin], range);
  return placed(scale, each => each);
}

// The border of what a front beats, from the best x on: steps between its points, and on to the edges of the
// drawing. `spots`: places of the points; `edges`: the worst x and y.
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

// The colour of each point: [function of a row, entries of the legend].
function coloursOf(points, name) {
  const blue = styleColour('--blue');
  if (!name) return [() => blue, []];
  const values = points.column(name);
  const words = different(values);
  if (words.length <= kMostColours) {
    const colours = new Map(words.map((word, i) => [word, styleColour(nthColour(i))]));
    return [row => colours.get(values[row]), words.map(word => [value(word), colours.get(word)])];
  }
  if (!points.isNumeric(name)) return [() => blue, [[`more than ${kMostColours} values`, blue]]];
  const [low, high] = [words[0], words.at(-1)];
  const stops = Array.from({length: 32}, (_, i) => css(heat(0.2 + 0.8 * i / 31)));
  return [
    row => stops[Math.round((values[row] - low) / (high - low) * 31)],
    [[brief(low), stops[0]], [brief(high), stops[31]]]
  ];
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
  const z = {id: 'z', name: '', best: 'min'};  // no name: the front is of two columns
  const axesOfFront = () => [x, y, z].filter(axis => axis.name);
  const state = {colour: points.keys.find(key => new Set(points.column(key)).size <= kMostColours) ?? ''};
  let repaint = () => {};
  const frontText = h('p', {class: 'note', id: 'front-text'});
  const legendHost = h('div');
  const linesOf =
      row => [y.name, x.name, z.name]
                 .filter(Boolean)
                 .map(name => `${name} ${points.textWithLoss(name, row)}`)
                 .concat(points.keys.slice(0, 8).map(key => `${key}: ${value(points.column(key)[row])}`));

  const draw = (host, width) => {
    const total = Math.min(640, Math.max(320, width * 0.62));
    const {plot, width: inner, height, context, clear} =
        layeredDrawing(host, width, total, {left: 64, right: 14, top: 26, bottom: 44}, 'Points');
    const [across, up] = [[x, [0, inner]], [y, [height, 0]]].map(
        ([axis, range]) => placesOf(points, axis.name, range, {isLog: axis.log, room: 0.03}));
    const spot = row => [across.at[row], up.at[row]];
    const [colourOf, entries] = coloursOf(points, state.colour);
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
          const [left, above] = spot(row).map(place => place - size / 2);
          if (points.lost[row] > 0)
            context.fillText('×', left, above + size);
          else
            context.fillRect(left, above, size, size);
        });
      }
      const front =
          axesOfFront().every(axis => points.isNumeric(axis.name)) ? points.front(axesOfFront()) : [];
      const edges = [x.best === 'min' ? inner : 0, y.best === 'min' ? 0 : height];
      const dot = (row, attributes) => s('circle', {cx: across.at[row], cy: up.at[row], ...attributes});
      const spots = front.map(row => {
        const go = event => (event.type === 'click' || event.key === 'Enter') && choose(row);
        return mark(dot(row, {r: 5, class: 'on-front', click: go, keydown: go}), linesOf(row));
      });
      const steps = stepsOf(front.map(spot), edges).join(' ');
      frontLayer.replaceChildren(
          ...z.name ? [] : [s('polyline', {class: 'front', points: steps})], ...spots,
          ...points.chosen >= 0 ? [dot(points.chosen, {r: 9, class: 'chosen'})] : []);
      linkMarks(host);
      const crosses = points.losing() > 0 ?
          ` Pixels are lost in ${whole(points.losing(points.selectedRows()))} of the points (×), ${
              whole(points.losing(front))} of the front.` :
          '';
      const ties = axesOfFront().some(({name}) => points.hasUncertainty(name));
      frontText.textContent = `${count(points.count, 'point')} of ${whole(points.size)} selected; ${
          whole(front.length)} of them on the front.${crosses}${
          ties ? ' What lies within the uncertainty ties.' : ''}`;
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
  const pick = (id, label, chosen, names, change, none = 'one colour') =>
      h('label', null, `${label} `, choice(id, names.map(name => [name, name || none]), chosen, name => {
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
    title: 'Two or three columns, and the points that no other beats',
    draw,
    body: [
      pickAxis(x), pickAxis(y),
      controls(
          pick('scatter-z', 'third', z.name, ['', ...numbers], name => Object.assign(z, {name}), 'none'),
          pick('best-z', 'better:', z.best, ['min', 'max'], best => Object.assign(z, {best}))),
      controls(
          pick(
              'scatter-colour', 'colour', state.colour, ['', ...points.names],
              colour => Object.assign(state, {colour})),
          legendHost),
      frontText
    ],
    note:
        'Drag to select points, click one for its board. Arrow keys go along the front, Enter opens a point.',
    numbers: () => points.numbers(
        [...new Set([...axesOfFront().map(axis => axis.name), ...points.keys])], points.front(axesOfFront()))
  });
  points.whenSelected(() => repaint());
  return {redraw: () => repaint()};
}

const kMostAxes = 9;
const kParallelHeight = 330;
const kMostWords = 12;  // an axis of a column with at most so many values has each of them
// Lines of the points that are not selected and of those that are.
const kMostLines = [800, 4000];

// Parallel coordinates: one axis for each column, one line for each point. Each axis can be brushed.
export function addParallel(page, points) {
  const defaults = [...points.keys.slice(0, kMostAxes - 2), ...points.figures.slice(0, 2)];
  const state = {names: defaults};
  let repaint = () => {};
  const draw = (host, width) => {
    const few = state.names.slice(0, Math.max(3, Math.floor(width / 85)));
    const {plot, width: inner, height, context, clear} = layeredDrawing(
        host, width, kParallelHeight, {left: 34, right: 34, top: 48, bottom: 14}, 'Parallel coordinates');
    const step = inner / Math.max(1, few.length - 1);
    const axes = few.map(
        (name, i) => ({name, x: i * step, ...placesOf(points, name, [height, 0], {mostWords: kMostWords})}));
    const lines = (colour, alpha, most, wanted) => {
      context.strokeStyle = colour;
      context.globalAlpha = alpha;
      context.beginPath();
      // The first rows are a fair sample: the points are in the order of their hashes.
      for (const row of [...points.selected.keys()].filter(each => points.selected[each] === wanted)
               .slice(0, most))
        axes.forEach(({x, at}, i) => i === 0 ? context.moveTo(x, at[row]) : context.lineTo(x, at[row]));
      context.stroke();
    };
    repaint = () => {
      clear();
      const [others, selected] = kMostLines;
      lines(styleColour('--faint'), 0.25, others, 0);
      lines(
          styleColour('--blue'), Math.max(0.06, Math.min(0.7, 60 / Math.max(1, points.count))), selected, 1);
    };
    axes.forEach(({name, x, scale, isNumeric, at}, i) => {
      const isLast = i === few.length - 1;
      const [anchor, shift] = i === 0 && few.length > 1 ? ['start', -30] :
          isLast                                        ? ['end', 30] :
                                                          ['middle', 0];
      const [head, ...tail] = name.split('.');
      const group =
          s('g', {transform: `translate(${x} 0)`}, s('line', {y1: 0, y2: height, class: 'base'}),
            mark(
                s('rect',
                  {x: -step / 2 + 2, y: -46, width: Math.max(10, step - 4), height: 34, class: 'reach'}),
                [name, 'Drag along the axis to select']),
            s('text', {x: shift, y: -30, 'text-anchor': anchor, class: 'label'},
              cut(tail.length ? head : '', step)),
            s('text', {x: shift, y: -17, 'text-anchor': anchor},
              cut(tail.length ? tail.join('.') : head, step)));
      let above = Infinity;
      for (const tick of scale.ticks(5)) {
        const y = scale(tick);
        if (above - y < 12) continue;
        above = y;
        const place = {x: isLast ? -4 : 4, y: y + 4, 'text-anchor': isLast ? 'end' : 'start'};
        group.append(
            s('text', {...place, class: 'tick halo'}, cut(isNumeric ? brief(tick) : tick, step * 0.8)));
      }
      const set = box =>
          points.filter(`axis ${name}`, box && (row => at[row] >= box.y0 && at[row] <= box.y1));
      const strip = s('g', {transform: 'translate(-14 0)'});
      addBrush(strip, {axis: 'y', width: 28, height, change: set, end: set});
      group.append(strip);
      plot.append(group);
    });
    for (const name of [...points.filters.keys()].filter(each => each.startsWith('axis ')))
      points.filters.delete(name);
    repaint();
  };
  const options =
      points.names.map(name => h('option', {value: name, selected: defaults.includes(name)}, name));
  const change = event => {
    state.names = [...event.target.selectedOptions].map(option => option.value);
    chart.redraw();
    points.filter('parallel', null);
  };
  const chart = addChart(page, {
    id: 'parallel',
    wide: true,
    draw,
    title: varyText(points.keys.length),
    note: 'One line for each selected point, at most 4000. Drag along an axis to select; click it to clear.',
    body: folded(
        'Axes', note('Ctrl-click takes or leaves an axis.'),
        h('select', {id: 'parallel-axes', multiple: true, size: 6, change}, options)),
    numbers: () => points.numbers(state.names, points.selectedRows())
  });
  points.whenSelected(() => repaint());
}
