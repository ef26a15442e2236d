// Plots in SVG, some of them above a canvas: scales from values to pixels, axes, and brushes.
import {button, controls, h, s} from './dom.js';
import {brief} from './format.js';
import {hideTooltip, showTooltip} from './tooltip.js';

function linearTicks(low, high, ticks) {
  const raw = (high - low) / Math.max(1, ticks);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5, 10].find(factor => factor * power >= raw * 0.999) ?? 10);
  const all = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high * (1 + 1e-12) + step * 1e-9; ++i)
    all.push(+(i * step).toPrecision(12));
  return all;
}

function logarithmicTicks(low, high, ticks) {
  for (const factors of [[1, 2, 3, 4, 5, 6, 7, 8, 9], [1, 2, 5], [1, 3], [1]]) {
    const all = [];
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); ++power)
      all.push(...factors.map(factor => +(factor * 10 ** power).toPrecision(3)));
    const shown = all.filter(tick => tick >= low * 0.9999 && tick <= high * 1.0001);
    if (shown.length > 1 && shown.length <= ticks + 1) return shown;
  }
  return linearTicks(low, high, ticks).filter(tick => tick > 0);
}

// A scale of numbers: scale(value), scale.invert(pixel), scale.ticks(about how many).
export function numeric([low, high], [from, to], isLog = false) {
  const half = (Math.abs(low) || 1) / 2;
  if (!(high > low)) [low, high] = isLog ? [low / 2, low * 2] : [low - half, low + half];
  const [there, back] = isLog ? [Math.log10, power => 10 ** power] : [same => same, same => same];
  const [first, span] = [there(low), there(high) - there(low)];
  const scale = value => from + (there(value) - first) / span * (to - from);
  scale.invert = pixel => back(first + (pixel - from) / (to - from) * span);
  scale.ticks = (ticks = 5) => (isLog ? logarithmicTicks : linearTicks)(low, high, ticks);
  scale.domain = [low, high];
  return scale;
}

// A scale of words: at equal distances, in their order.
export function ordinal(words, [from, to]) {
  const place = new Map(words.map((word, index) => [word, index]));
  const scale = word => from + (to - from) / words.length * (place.get(word) + 0.5);
  scale.ticks = () => words;
  return scale;
}

// The width of a text in the small type of charts, in pixels.
export const textWidth = text => text.length * 6.3;
export const cut = (text, width) => {
  const letters = Math.floor(width / 6.3);
  return text.length <= letters ? text : `${text.slice(0, Math.max(1, letters - 1))}…`;
};

// The ticks of a scale as [{at, label}], without those whose labels would touch.
export function clearTicks(scale, ticks, text = brief) {
  let end = -Infinity;
  return scale.ticks(ticks).map(tick => ({at: scale(tick), label: text(tick)})).filter(({at, label}) => {
    const half = label.length * 3.2 + 4;
    if (at - half < end) return false;
    end = at + half;
    return true;
  });
}

// An axis below a plot of this height, with grid lines.
export const axisBelow = (scale, width, height, label, text = brief) =>
    s('g', {class: 'axis', 'aria-hidden': 'true'},
      clearTicks(scale, width / 70, text)
          .map(
              ({at, label: tick}) =>
                  [s('line', {x1: at, x2: at, y1: 0, y2: height, class: 'grid'}),
                   s('text', {x: at, y: height + 15, 'text-anchor': 'middle'}, tick)]),
      s('line', {x1: 0, x2: width, y1: height, y2: height, class: 'base'}),
      s('text', {x: width, y: height + 31, 'text-anchor': 'end', class: 'label'}, label));

// The same on the left side. The label stands above.
export const axisLeft = (scale, width, height, label, {ticks = height / 45, grid = true} = {}) =>
    s('g', {class: 'axis', 'aria-hidden': 'true'},
      scale.ticks(ticks).map(
          tick =>
              [grid && s('line', {x1: 0, x2: width, y1: scale(tick), y2: scale(tick), class: 'grid'}),
               s('text', {x: -6, y: scale(tick) + 4, 'text-anchor': 'end'}, brief(tick))]),
      label && s('text', {x: -6, y: -10, class: 'label'}, label));

// An empty drawing with margins: {svg, plot, width, height}; `plot` is the group inside the margins.
export function drawing(host, width, height, {left = 0, right = 0, top = 0, bottom = 0}, label = '') {
  const plot = s('g', {transform: `translate(${left} ${top})`});
  const svg =
      s('svg', {viewBox: `0 0 ${width} ${height}`, width, height, role: 'group', 'aria-label': label}, plot);
  host.append(svg);
  return {svg, plot, width: width - left - right, height: height - top - bottom};
}

// A drawing above a canvas with the resolution of the screen. `context` has CSS pixels and the origin of the
// plot; `clear()` empties the canvas.
export function layeredDrawing(host, width, height, margins, label) {
  const density = window.devicePixelRatio || 1;
  const size = {width: Math.round(width * density), height: Math.round(height * density)};
  const canvas = h('canvas', {...size, 'aria-hidden': 'true', style: `width:${width}px;height:${height}px`});
  const context = canvas.getContext('2d');
  context.scale(density, density);
  context.translate(margins.left, margins.top);
  host.classList.add('layered');
  host.append(canvas);
  const clear = () => context.clearRect(-margins.left, -margins.top, width, height);
  return {...drawing(host, width, height, margins, label), context, clear};
}

// Adds a brush to a plot of this size. axis: 'x', 'y' or 'xy'. `change(box)` is called while the pointer
// moves, `end(box, place)` when it is released. box: {x0, x1, y0, y1} in pixels, or null after a click, which
// clears the brush. place: {x, y}. `tip(place)`: the lines of a tooltip of the place, or null.
export function addBrush(plot, {axis, width, height, change, end, tip}) {
  const area = s('rect', {x: 0, y: 0, width, height, class: `brush brush-${axis}${tip ? ' hovers' : ''}`});
  const shown = s('rect', {class: 'brushed'});
  plot.append(area, shown);
  let from = null;
  const placeOf = event => {
    const box = area.getBoundingClientRect();
    return {
      x: (event.clientX - box.left) / box.width * width,
      y: (event.clientY - box.top) / box.height * height
    };
  };
  const show = box => {
    const {x0, x1, y0, y1} = box ?? {x0: 0, x1: 0, y0: 0, y1: 0};
    for (const [name, value] of Object.entries({x: x0, y: y0, width: x1 - x0, height: y1 - y0}))
      shown.setAttribute(name, value);
  };
  const boxTo = to => {
    if ([...axis].every(name => Math.abs(to[name] - from[name]) < 4)) return null;
    const rangeOf = (name, most) => axis.includes(name) ?
        [from[name], to[name]].sort((a, b) => a - b).map(pixel => Math.max(0, Math.min(most, pixel))) :
        [0, most];
    const [[x0, x1], [y0, y1]] = [rangeOf('x', width), rangeOf('y', height)];
    return {x0, x1, y0, y1};
  };
  area.addEventListener('pointerdown', event => {
    if (event.button !== 0) return;
    from = placeOf(event);
    area.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  area.addEventListener('pointermove', event => {
    const lines = tip && !event.buttons && tip(placeOf(event));
    if (lines)
      showTooltip(lines, event.clientX, event.clientY);
    else if (tip && !event.buttons)
      hideTooltip();
    if (!from) return;
    const box = boxTo(placeOf(event));
    show(box);
    change?.(box);
  });
  area.addEventListener('pointerup', event => {
    if (!from) return;
    const place = placeOf(event);
    const box = boxTo(place);
    from = null;
    show(box);
    end?.(box, place);
  });
  area.addEventListener('pointercancel', () => {
    from = null;
  });
  if (tip) area.addEventListener('pointerleave', hideTooltip);
}

// The shown part of the range 0 to `last`, at least `least` long, and its buttons. `step`: the share of the
// part by which the buttons of `names` move it. `changed()` is called after each change.
export class Zoom {
  constructor({last, least, step, from = 0, to = last}, names, changed) {
    Object.assign(this, {last, least, from, to, changed});
    const move = (label, name, first, second) => button(label, () => {
      const size = this.to - this.from;
      this.set(this.from + first * size, this.to + second * size);
    }, {'aria-label': name});
    const [[back, backName], [on, onName], all] = names;
    this.controls = controls(
        move('+', 'Zoom in', 0.25, -0.25), move('−', 'Zoom out', -0.5, 0.5),
        move(back, backName, -step, -step), move(on, onName, step, step),
        button(all, () => this.set(0, last)));
  }
  // Of whole numbers if `least` is one.
  set(from, to) {
    const size = Math.min(this.last, Math.max(this.least, Math.round(to - from)));
    this.from = Math.max(0, Math.min(this.last - size, Math.round(from)));
    this.to = this.from + size;
    this.changed();
  }
}
