// What one step of each knob gains, and its price.
import {h, s} from './dom.js';
import {brief, count, fixed, percent, rate, signed} from './format.js';
import {addChart, cut, drawing} from './chart.js';
import {adviceOf, priceOf, priceText, stepText} from './advice.js';
import {rateOf} from './findings.js';
import {axisBelow, axisLeft, logarithmic} from './scale.js';
import {mark} from './tooltip.js';

const kNearRoof = 0.9;

export function addKnobs(page, run) {
  if (!run.knobs) {
    addChart(page, {
      id: 'knobs',
      title: 'What to change first',
      note: 'Left out by --quick. `stereotlm report` without it tries one step of each knob.'
    });
    return;
  }
  const {board, steps, forbidden, failed} = run.knobs;
  const impossible = forbidden.length + failed.length;
  const advice = adviceOf(run);
  const now = board.frames_per_second;
  const state = {keep: false};
  const shown = () => steps.filter(step => step.has_effect && !(state.keep && step.changes_disparities));
  const prices = [['slices', 'slices'], ['blockRams', 'block RAMs'], ['banks', 'banks']];
  const draw = (host, width) => {
    const rows = shown();
    const columns = width > 560 ? prices : [];
    const right = 64 + columns.length * 78;
    const {plot, width: inner, height} = drawing(
        host, width, rows.length * 34 + 62, {left: 6, right, top: 22, bottom: 40},
        'Frames a second after a step');
    const all = [now, ...rows.map(step => step.frames_per_second)].filter(each => each > 0);
    const x = logarithmic([Math.min(...all) * 0.95, Math.max(...all) * 1.05], [0, inner]);
    plot.append(axisBelow(x, inner, height, 'frames/s (logarithmic)'));
    plot.append(
        s('line', {x1: x(now), x2: x(now), y1: -4, y2: height, class: 'now'}),
        s('text', {
          x: x(now) + (x(now) > inner / 2 ? -4 : 4),
          y: -8,
          'text-anchor': x(now) > inner / 2 ? 'end' : 'start',
          class: 'now-label'
        },
          cut(`now: ${rate(now)}`, inner)));
    columns.forEach(
        ([, name], i) => plot.append(s(
            'text', {x: inner + 64 + 78 * (i + 1) - 4, y: -8, 'text-anchor': 'end', class: 'label'}, name)));
    rows.forEach((step, line) => {
      const y = line * 34;
      const gain = step.frames_per_second / now - 1;
      const at = x(Math.max(step.frames_per_second, x.domain[0]));
      const colour = gain > 0 ? '--blue' : '--vermilion';
      const label = stepText(step) + (step.changes_disparities ? ' *' : '') + (step.loses_pixels ? ' †' : '');
      const price = priceOf(step, board);
      plot.append(
          s('text', {x: 0, y: y + 12, class: step === advice.first ? 'halo strong' : 'halo'},
            cut(label, inner - 4)),
          s('text', {x: inner + 60, y: y + 22, 'text-anchor': 'end', class: 'value'},
            signed(gain, each => percent(each, each < 0.0095 ? 2 : 1))),
          mark(
              s('rect', {
                x: Math.min(at, x(now)),
                y: y + 17,
                width: Math.max(1, Math.abs(at - x(now))),
                height: 9,
                style: `fill:var(${colour})`
              }),
              [
                stepText(step),
                `${rate(step.frames_per_second)} frames/s, ${signed(gain, each => percent(each, 2))}`,
                `takes ${priceText(step, board)}`, step.changes_disparities && 'changes the disparities',
                step.loses_pixels && 'captures lose pixels'
              ].filter(Boolean)));
      columns.forEach(
          ([key], i) => plot.append(
              s('text', {x: inner + 64 + 78 * (i + 1) - 4, y: y + 22, 'text-anchor': 'end', class: 'value'},
                price[key] ? signed(price[key], brief) : '·')));
    });
  };
  const keep =
      h('label', {class: 'check'}, h('input', {
          type: 'checkbox',
          id: 'keep-disparities',
          change: event => {
            state.keep = event.target.checked;
            chart.redraw();
          }
        }),
        ' only what keeps the disparities');
  const without = steps.filter(step => !step.has_effect).map(step => step.knob);
  const chart = addChart(page, {
    id: 'knobs',
    wide: true,
    draw,
    title: advice.first ? `First: ${stepText(advice.first)}, ${signed(advice.gain(advice.first), percent)}` :
                          'No single step gains 1 % and keeps the disparities',
    note: `One step of each knob, simulated: ${
              count(board.frames, 'frame')} each. Right: gain, and what it takes in ` +
        'addition. *: changes the disparities. †: captures lose pixels.',
    body: h(
        'div', null, keep,
        without.length > 0 &&
            h('p', {class: 'note'},
              `Without effect here: ${
                      [...new Set(without)]
                          .filter(knob => !steps.some(step => step.knob === knob && step.has_effect))
                          .join(', ')}.`),
        impossible > 0 &&
            h('details', null,
              h('summary', null, `${count(impossible, 'step')} ${impossible === 1 ? 'is' : 'are'} not possible`),
              h('ul', {class: 'note'},
                [...forbidden, ...failed].map(step => h('li', null, `${stepText(step)}: ${step.reason}`))))),
    numbers:
        () => [
            [
              'knob', 'from', 'to', 'frames_per_second', 'gain_percent', 'slices', 'block_rams',
              'multipliers', 'banks_used', 'changes_disparities', 'loses_pixels'
            ],
            steps.map(
                step =>
                    [step.knob, step.from, step.to, step.frames_per_second,
                     100 * (step.frames_per_second / now - 1), step.area.slices, step.area.block_rams,
                     step.area.multipliers, step.banks_used, String(step.changes_disparities),
                     String(step.loses_pixels)])]
  });
}

// The roofline: how often the busiest bank is accessed for a pixel, against pixels a second.
export function addRoofline(page, run) {
  if (!run.knobs) return;
  const {board, steps} = run.knobs;
  const {by} = rateOf(run);
  const setting = key => run.settings.find(each => each.key === key).value;
  const pixels = setting('image.width') * setting('image.height');
  const point = (step, name) => ({
    name,
    accesses: step.busiest_bank.accesses_per_pixel,
    bank: step.busiest_bank.name,
    speed: step.frames_per_second * pixels / 1e6,
    fps: step.frames_per_second,
    clock: step.clock_mhz
  });
  const here = point(board, 'this board');
  const all = steps.filter(step => step.has_effect)
                  .map(step => point(step, stepText(step)))
                  .filter(each => each.accesses > 0);
  const roofAt = here.clock / here.accesses;
  const share = here.speed / roofAt;
  const draw = (host, width) => {
    const {plot, width: inner, height} = drawing(
        host, width, Math.min(380, Math.max(280, width * 0.6)), {left: 46, right: 14, top: 24, bottom: 40},
        'Roofline');
    const xs = [here, ...all].map(each => each.accesses);
    const ys = [here, ...all].map(each => each.speed).filter(each => each > 0);
    const x = logarithmic([Math.min(...xs) * 0.8, Math.max(...xs) * 1.25], [0, inner]);
    const y = logarithmic([Math.min(...ys) * 0.8, Math.max(...ys, roofAt) * 1.3], [height, 0]);
    plot.append(
        axisBelow(x, inner, height, 'accesses of the busiest bank for a pixel'), axisLeft(y, inner, height));
    plot.append(s('text', {x: -6, y: -10, class: 'label', 'text-anchor': 'start'}, 'Mpixels/s'));
    const path = Array.from({length: 200}, (_, i) => x.domain[0] * (x.domain[1] / x.domain[0]) ** (i / 199))
                     .filter(each => y(here.clock / each) >= 0 && y(here.clock / each) <= height)
                     .map(each => `${x(each)},${y(here.clock / each)}`);
    plot.append(s('polyline', {points: path.join(' '), class: 'roof'}));
    for (const each of all) {
      plot.append(mark(s('circle', {cx: x(each.accesses), cy: y(each.speed), r: 4, class: 'neighbour'}), [
        each.name, `${fixed(each.accesses, 2)} accesses of ${each.bank} a pixel`,
        `${fixed(each.speed, 2)} Mpixels/s, ${rate(each.fps)} frames/s`
      ]));
    }
    plot.append(
        mark(s('circle', {cx: x(here.accesses), cy: y(here.speed), r: 7, style: 'fill:var(--vermilion)'}), [
          'this board', `${fixed(here.accesses, 2)} accesses of ${here.bank} a pixel`,
          `${fixed(here.speed, 2)} Mpixels/s, ${percent(share)} of the roof`
        ]));
    const label = `${here.bank}: one access a cycle of ${here.clock} MHz`;
    plot.append(s('text', {x: inner, y: 8, 'text-anchor': 'end', class: 'label halo'}, cut(label, inner)));
  };
  addChart(page, {
    id: 'roofline',
    draw,
    title: `${here.bank} works at ${percent(share)} of its roof: ` +
        (by.startsWith('bank') ? 'fewer accesses are the way up' :
             share > kNearRoof ? `a faster ${by} needs fewer accesses too` :
                                 `${by} limits`),
    note:
        'The line is what a bank with one access a cycle allows. Small: the board after one step of a knob.',
    numbers: () => [
        ['board', 'bank', 'accesses_per_pixel', 'megapixels_per_second', 'frames_per_second', 'clock_mhz'],
        [here, ...all].map(each => [each.name, each.bank, each.accesses, each.speed, each.fps, each.clock])]
  });
}
