// Charts of bars: one below the other, and side by side.
import {h, s} from './dom.js';
import {most} from './format.js';
import {axisLeft, clearTicks, drawing, numeric} from './plot.js';
import {mark} from './tooltip.js';

const kColumnsHeight = 250;
const kWidestColumn = 40;

// Bars one below the other. The browser places them, so that they need no width. rows: [{name, strong, bars:
// [{from, to, colour, lines}], texts: [..]}]: the texts stand behind the bars; a bar with `dot` is a dot at
// `to`, with a line to it. `domain`: range of the scale. With `axis`, its label, the scale has ticks. now:
// {value, text}: a line across all rows. `heads`: above the texts. `above`: the names stand above the bars.
export function drawBars(host, {rows, domain, isLog = false, axis, now, heads = [], above = false}) {
  const scale = numeric(domain, [0, 100], isLog);
  const barOf = ({from = domain[0], to, colour, dot, lines}) => {
    const [left, right] = [scale(Math.min(from, to)), scale(Math.max(from, to))];
    const place = `left:${left}%;width:${right - left}%`;
    const style = `background:var(${colour})`;
    if (!dot) return mark(h('i', {class: 'bar-part', style: `${place};${style}`}), lines);
    return [
      h('i', {class: 'dot-line', style: place}),
      mark(h('i', {class: 'dot', style: `left:${right}%;${style}`}), lines)
    ];
  };
  const nowPlace = now && scale(now.value);
  const nowText = now &&
      h('span', {class: 'now-text', style: nowPlace > 50 ? `right:${100 - nowPlace}%` : `left:${nowPlace}%`},
        now.text);
  const cells = (name, lane, texts, strong) =>
      [(name || !above) && h('span', {class: strong ? 'name strong' : 'name'}, name),
       h('div', {class: 'lane'}, lane), texts.map(text => h('span', {class: 'value'}, text))];
  const behind =
      h('div', {class: 'behind'}, now && h('i', {class: 'now-line', style: `left:${nowPlace}%`}),
        domain[0] < 0 && h('i', {class: 'zero-line', style: `left:${scale(0)}%`}));
  const texts = rows[0]?.texts ?? [];
  const columns =
      `${above ? '' : 'fit-content(44%) '}minmax(60px, 1fr)${' max-content'.repeat(texts.length)}`;
  host.append(
      h('div', {class: above ? 'bars above' : 'bars', style: `grid-template-columns:${columns}`}, behind,
        (now || heads.length > 0) && cells('', nowText, texts.map((_, i) => heads[i] ?? '')),
        rows.map(({name, bars, texts, strong}) => cells(name, bars.map(barOf), texts, strong))));
  if (!axis) return;
  const width = behind.clientWidth;
  const ticks = clearTicks(numeric(domain, [0, width], isLog), width / 70);
  behind.prepend(...ticks.map(({at}) => h('i', {class: 'tick-line', style: `left:${at}px`})));
  host.append(
      h('div', {
        class: 'bars-axis',
        'aria-hidden': 'true',
        style: `margin-left:${behind.offsetLeft}px;width:${width}px`
      },
        ticks.map(({at, label}) => h('span', {style: `left:${at}px`}, label)), h('p', null, axis)));
}

// Bars side by side. groups: a list for each place, with a {parts: [[size, colour], ..], lines} for each bar,
// whose parts are stacked.
export function drawColumns(host, width, {groups, label, unit, below}) {
  const {plot, width: inner, height} =
      drawing(host, width, kColumnsHeight, {left: 48, right: 8, top: 22, bottom: 28}, label);
  const sizeOf = ({parts}) => parts.reduce((all, [size]) => all + size, 0);
  const y = numeric([0, 1.05 * most(groups.flat().map(sizeOf))], [height, 0]);
  const step = inner / groups.length;
  plot.append(axisLeft(y, inner, height, unit));
  groups.forEach((bars, place) => {
    const wide = Math.max(0.7, Math.min(kWidestColumn, (step - (step > 4 ? 2 : 0)) / bars.length));
    bars.forEach(({parts, lines}, i) => {
      const x = place * step + (step - wide * bars.length) / 2 + i * wide;
      let end = height;
      const rects = parts.map(([size, colour]) => {
        const high = height - y(size);
        end -= high;
        return s('rect', {x, y: end, width: wide, height: high, style: `fill:var(${colour})`});
      });
      plot.append(mark(s('g', null, rects), lines));
    });
  });
  plot.append(
      s('line', {x1: 0, x2: inner, y1: height, y2: height, class: 'base'}),
      s('text', {x: inner, y: height + 18, 'text-anchor': 'end', class: 'label'}, below));
}
