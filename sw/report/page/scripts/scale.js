// Scales from values to pixels, their ticks and axes.
import {s} from './dom.js';
import {brief} from './format.js';

function niceStep(span, ticks) {
  const raw = span / Math.max(1, ticks);
  const power = 10 ** Math.floor(Math.log10(raw));
  const factor = [1, 2, 5, 10].find(each => each * power >= raw * 0.999) ?? 10;
  return factor * power;
}

export function linear([low, high], [from, to]) {
  if (!(high > low)) [low, high] = [low - (Math.abs(low) || 1) / 2, low + (Math.abs(low) || 1) / 2];
  const scale = value => from + (value - low) / (high - low) * (to - from);
  scale.invert = pixel => low + (pixel - from) / (to - from) * (high - low);
  scale.ticks = (ticks = 5) => {
    const step = niceStep(high - low, ticks);
    const all = [];
    for (let i = Math.ceil(low / step - 1e-9); i * step <= high * (1 + 1e-12) + step * 1e-9; ++i)
      all.push(+(i * step).toPrecision(12));
    return all;
  };
  scale.domain = [low, high];
  return scale;
}

export function logarithmic([low, high], [from, to]) {
  if (!(high > low)) [low, high] = [low / 2, low * 2];
  const inner = linear([Math.log10(low), Math.log10(high)], [from, to]);
  const scale = value => inner(Math.log10(value));
  scale.invert = pixel => 10 ** inner.invert(pixel);
  scale.ticks = (ticks = 5) => {
    for (const factors of [[1, 2, 3, 4, 5, 6, 7, 8, 9], [1, 2, 5], [1, 3], [1]]) {
      const all = [];
      for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); ++power) {
        for (const factor of factors) {
          const tick = +(factor * 10 ** power).toPrecision(3);
          if (tick >= low * 0.9999 && tick <= high * 1.0001) all.push(tick);
        }
      }
      if (all.length <= ticks + 1 && (all.length > 1 || factors.length === 1))
        return all.length > 1 ? all : linear([low, high], [0, 1]).ticks(ticks);
    }
    return linear([low, high], [0, 1]).ticks(ticks).filter(tick => tick > 0);
  };
  scale.domain = [low, high];
  return scale;
}

// Values that are words: at equal distances, in their order.
export function ordinal(words, [from, to]) {
  const place = new Map(words.map((word, index) => [word, index]));
  const step = (to - from) / words.length;
  const scale = word => from + step * (place.get(word) + 0.5);
  scale.invert = pixel => words[Math.max(0, Math.min(words.length - 1, Math.floor((pixel - from) / step)))];
  scale.ticks = () => words;
  scale.domain = words;
  scale.step = Math.abs(step);
  return scale;
}

// Adds an axis below a plot of this height, with grid lines. Returns its group.
export function axisBelow(scale, width, height, label, {ticks = width / 70, text = brief, grid = true} = {}) {
  let end = -Infinity;
  const shown = scale.ticks(ticks).map(tick => ({at: scale(tick), label: text(tick)})).filter(tick => {
    const half = tick.label.length * 3.2 + 4;
    if (tick.at - half < end) return false;
    end = tick.at + half;
    return true;
  });
  return s(
      'g', {class: 'axis', 'aria-hidden': 'true'},
      shown.map(
          tick =>
              [grid && s('line', {x1: tick.at, x2: tick.at, y1: 0, y2: height, class: 'grid'}),
               s('text', {x: tick.at, y: height + 15, 'text-anchor': 'middle'}, tick.label),
  ]),
      s('line', {x1: 0, x2: width, y1: height, y2: height, class: 'base'}),
      s('text', {x: width, y: height + 31, 'text-anchor': 'end', class: 'label'}, label));
}

// The same on the left side. The label stands above.
export function axisLeft(scale, width, height, label, {ticks = height / 45, text = brief, grid = true} = {}) {
  return s(
      'g', {class: 'axis', 'aria-hidden': 'true'},
      scale.ticks(ticks).map(
          tick =>
              [grid && s('line', {x1: 0, x2: width, y1: scale(tick), y2: scale(tick), class: 'grid'}),
               s('text', {x: -6, y: scale(tick) + 4, 'text-anchor': 'end'}, text(tick)),
  ]),
      label && s('text', {x: -6, y: -10, class: 'label'}, label));
}
