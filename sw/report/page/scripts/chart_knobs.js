// What each single change of the board gains, and its price.
import {h, s} from './dom.js';
import {count, fixed, gainText, percent, rate, signed, whole} from './format.js';
import {addChart, cut, drawing, textWidth} from './chart.js';
import {adviceOf, newPartsOf, priceOf, priceText, shortStepText, stepText} from './advice.js';
import {kindOfSteps, rateOf, resourceText, withVerb} from './findings.js';
import {axisBelow, axisLeft, logarithmic} from './scale.js';
import {mark} from './tooltip.js';

const kNearRoof = 0.9;

// A change that gains or loses less is folded, until it is asked for.
const kFolded = 0.001;
const kBarLine = 24;
const kNarrowLine = 34;  // with the name above its bar
const kMostNameWidth = 400;
const kGainWidth = 64;
const kBold = 1.1;  // its width, of that of other letters
const kLogicWidth = 76;
const kPartsWidth = 132;

export function addKnobs(page, run) {
  if (!run.knobs) {
    addChart(page, {
      id: 'knobs',
      title: 'What to change first',
      note: 'Left out by --quick. `stereotlm report` without it tries single changes of the board.'
    });
    return;
  }
  const {board, steps, forbidden, failed} = run.knobs;
  const impossible = forbidden.length + failed.length;
  const advice = adviceOf(run);
  const now = board.frames_per_second;
  const kind = kindOfSteps(run);
  const state = {keep: false, all: false};
  const gainOf = step => step.frames_per_second / now - 1;
  const isSmall = step => step !== advice.first && Math.abs(gainOf(step)) < kFolded;
  const listed = () => steps.filter(step => step.has_effect && !(state.keep && step.changes_disparities));
  const fold = h('button', {
    type: 'button',
    class: 'small',
    id: 'fold-changes',
    click: () => {
      state.all = !state.all;
      chart.redraw();
    }
  });
  const draw = (host, width) => {
    const rows = listed().filter(step => state.all || !isSmall(step));
    const small = listed().filter(isSmall).length;
    fold.hidden = small === 0;
    fold.setAttribute('aria-expanded', String(state.all));
    fold.textContent = `${state.all ? '▾' : '▸'} ${count(small, 'change')} that gain${
        small === 1 ? 's' : ''} or lose${small === 1 ? 's' : ''} less than 0.1 %`;
    const isWide = width > 760;
    const marks = step => (step.changes_disparities ? ' *' : '') + (step.loses_pixels ? ' †' : '');
    const nameOf = step => shortStepText(step) + marks(step);
    // Without the present value where there is no room for it.
    const fittedName = (step, room) => {
      const width = step === advice.first ? room / kBold : room;
      return textWidth(nameOf(step)) <= width ? nameOf(step) :
                                                cut(nameOf(step).replace(/: .* →/, ' →'), width);
    };
    const left = isWide ?
        Math.min(kMostNameWidth, Math.max(...rows.map(step => textWidth(nameOf(step))), 60) + 10) :
        0;
    const columns =
        isWide ? [['slices', kLogicWidth], ['block RAMs', kLogicWidth], ['new parts', kPartsWidth]] : [];
    const right = (isWide ? kGainWidth : 0) + columns.reduce((all, [, wide]) => all + wide, 0);
    const line = isWide ? kBarLine : kNarrowLine;
    const {plot, width: inner, height} = drawing(
        host, width, rows.length * line + 62, {left, right, top: 22, bottom: 40},
        'Frames a second after a single change');
    const all = [now, ...rows.map(step => step.frames_per_second)].filter(each => each > 0);
    const x = logarithmic([Math.min(...all) * 0.95, Math.max(...all) * 1.05], [0, inner]);
    plot.append(axisBelow(x, inner, height, `frames/s, ${kind} (logarithmic)`, {grid: isWide}));
    plot.append(
        s('line', {x1: x(now), x2: x(now), y1: -4, y2: height, class: 'now'}),
        s('text', {
          x: x(now) + (x(now) > inner / 2 ? -4 : 4),
          y: -8,
          'text-anchor': x(now) > inner / 2 ? 'end' : 'start',
          class: 'now-label'
        },
          cut(`now: ${rate(now)}, ${kind}`, inner)));
    const value = (at, y, text) => s('text', {x: at, y, 'text-anchor': 'end', class: 'value'}, text);
    let at = inner + kGainWidth;
    for (const [name, wide] of columns)
      plot.append(s('text', {x: at += wide, y: -8, 'text-anchor': 'end', class: 'label'}, name));
    rows.forEach((step, number) => {
      const y = number * line;
      const gain = gainOf(step);
      const end = x(Math.max(step.frames_per_second, x.domain[0]));
      const price = priceOf(step, board);
      const name = {class: step === advice.first ? 'halo strong' : 'halo'};
      plot.append(
          isWide ? s('text', {x: -8, y: y + 17, 'text-anchor': 'end', ...name}, fittedName(step, left - 8)) :
                   s('text', {x: 0, y: y + 14, ...name}, fittedName(step, inner - kGainWidth)),
          value(isWide ? inner + kGainWidth - 4 : inner, y + (isWide ? 17 : 14), gainText(gain)),
          mark(
              s('rect', {
                x: Math.min(end, x(now)),
                y: y + (isWide ? 7 : 19),
                width: Math.max(1, Math.abs(end - x(now))),
                height: isWide ? 12 : 9,
                style: `fill:var(${gain > 0 ? '--blue' : '--vermilion'})`
              }),
              [
                stepText(step), `${rate(step.frames_per_second)} frames/s, ${kind} (${gainText(gain)})`,
                `takes ${priceText(step, board)}`, step.changes_disparities && 'changes the disparities',
                step.loses_pixels && 'captures lose pixels', ...step.sets.map(set => `--set '${set}'`)
              ].filter(Boolean)));
      const cells = [price.slices, price.blockRams].map(each => each ? signed(each, whole) : '0');
      cells.push(newPartsOf(step).join(', ') || 'none');
      let place = inner + kGainWidth;
      columns.forEach(([, wide], i) => {
        place += wide;
        plot.append(value(place, y + 17, cut(cells[i], wide - 4)));
      });
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
  const without = [...new Set(steps.filter(step => !step.has_effect).map(step => step.knob))].filter(
      knob => !steps.some(step => step.knob === knob && step.has_effect));
  const chart = addChart(page, {
    id: 'knobs',
    wide: true,
    draw,
    title: advice.first ? `First: ${shortStepText(advice.first)}, ${gainText(advice.gain(advice.first))}` :
                          'No single change gains 1 % and keeps the disparities',
    note: `One setting changed at a time, simulated with ${
              count(board.frames, 'frame')} each. Right: the gain, and what the change takes in ` +
        'addition. First: the largest gain that needs nothing new; if there is none, the largest of ' +
        'all; where captures lose pixels, the best change that ends that. *: changes the disparities. †: captures lose pixels.',
    body: h(
        'div', null, keep,
        without.length > 0 && h('p', {class: 'note'}, `Without effect here: ${without.join(', ')}.`),
        impossible > 0 &&
            h('details', null,
              h('summary', null,
                `${count(impossible, 'change')} ${impossible === 1 ? 'is' : 'are'} not possible`),
              h('ul', {class: 'note'},
                [...forbidden, ...failed].map(step => h('li', null, `${stepText(step)}: ${step.reason}`))))),
    foot: fold,
    numbers:
        () => [
            [
              'knob', 'from', 'to', 'frames_per_second', 'gain_percent', 'slices', 'block_rams',
              'multipliers', 'banks_used', 'new_banks', 'changes_disparities', 'loses_pixels', 'sets'
            ],
            steps.map(
                step =>
                    [step.knob, step.from, step.to, step.frames_per_second,
                     100 * (step.frames_per_second / now - 1), step.area.slices, step.area.block_rams,
                     step.area.multipliers, step.banks_used, step.new_banks, String(step.changes_disparities),
                     String(step.loses_pixels), step.sets.join(' ')])]
  });
}

// The roofline: how often the busiest bank is accessed for a pixel, against pixels a second.
export function addRoofline(page, run) {
  if (!run.knobs) return;
  const {board, steps} = run.knobs;
  const {by} = rateOf(run);
  const kind = kindOfSteps(run);
  const {first, largest} = adviceOf(run);
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
                  .map(step => ({...point(step, shortStepText(step)), step}))
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
        axisBelow(x, inner, height, 'accesses of the busiest bank for a pixel (logarithmic)'),
        axisLeft(y, inner, height));
    plot.append(
        s('text', {x: -6, y: -10, class: 'label', 'text-anchor': 'start'}, 'Mpixels/s (logarithmic)'));
    const path = Array.from({length: 200}, (_, i) => x.domain[0] * (x.domain[1] / x.domain[0]) ** (i / 199))
                     .filter(each => y(here.clock / each) >= 0 && y(here.clock / each) <= height)
                     .map(each => `${x(each)},${y(here.clock / each)}`);
    plot.append(s('polyline', {points: path.join(' '), class: 'roof'}));
    const isNamed = ({step}) => step === first || step === largest;
    const linesOf = each =>
        [each.name, `${fixed(each.accesses, 2)} accesses of ${each.bank} a pixel`,
         `${fixed(each.speed, 2)} Mpixels/s, ${rate(each.fps)} frames/s, ${kind}`];
    for (const each of [...all].sort((a, b) => isNamed(a) - isNamed(b))) {
      plot.append(mark(
          s('circle',
            {cx: x(each.accesses), cy: y(each.speed), r: isNamed(each) ? 7 : 4, class: 'neighbour'}),
          linesOf(each)));
    }
    plot.append(mark(
        s('circle', {cx: x(here.accesses), cy: y(here.speed), r: 7, style: 'fill:var(--vermilion)'}),
        [...linesOf(here), `${percent(share)} of the roof`]));
    // The names of the large dots, each beside its dot where no other name is.
    const taken = [];
    for (const each of [here, ...all.filter(isNamed)]) {
      const [at, isLeft] = [x(each.accesses), x(each.accesses) > inner / 2];
      let below = y(each.speed) + 4;
      while (taken.some(other => Math.abs(other - below) < 15)) below += 15;
      taken.push(below);
      plot.append(
          s('text',
            {x: at + (isLeft ? -11 : 11), y: below, 'text-anchor': isLeft ? 'end' : 'start', class: 'halo'},
            cut(each.name, isLeft ? at - 11 : inner - at - 11)));
    }
    const label = `roof: ${here.bank} at ${here.clock} MHz`;
    plot.append(
        s('text', {x: inner, y: -10, 'text-anchor': 'end', class: 'label halo'}, cut(label, inner - 150)));
  };
  addChart(page, {
    id: 'roofline',
    draw,
    title: `${here.bank} works at ${percent(share)} of its roof: ` +
        (by.startsWith('bank') ? 'fewer accesses are the way up' :
             share > kNearRoof ? `a faster ${resourceText(by).replace('the ', '')} needs fewer accesses too` :
                                 withVerb(by, 'limit')),
    note:
        'The line is the roof: what a bank with one access a cycle allows. Both axes are logarithmic. Large dots: ' +
        'this board (orange), the first change and the largest gain. Small dots: all other single changes.',
    numbers: () => [
        ['board', 'bank', 'accesses_per_pixel', 'megapixels_per_second', 'frames_per_second', 'clock_mhz'],
        [here, ...all].map(each => [each.name, each.bank, each.accesses, each.speed, each.fps, each.clock])]
  });
}
