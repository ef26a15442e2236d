// What each single change of the board gains, and what the core takes of its FPGA.
import {
    adviceOf, gainOf, hasEffect, isWithin, newPartsOf, priceOf, priceText, stepText,
} from './advice.js';
import {drawBars} from './bars.js';
import {addChart, addLeftOut} from './card.js';
import {button, checkBox, folded, h, note} from './dom.js';
import {kindOfSteps} from './findings.js';
import {count, fixed, gainText, lossText, most, percent, rate, signed, sum, whole} from './format.js';

// A change that gains or loses less is folded, until it is asked for.
const kFolded = 0.001;
const kWide = 760;  // pixels; narrower, the names stand above the bars, and prices are in the tooltips

export function addKnobs(page, run) {
  if (!run.knobs) return addLeftOut(page, 'knobs', 'What to change first');
  const board = run.knobs;
  const impossible = [...board.impossible, ...board.failed];
  const advice = adviceOf(run);
  const now = board.frames_per_second;
  const kind = kindOfSteps(run);
  const state = {keep: false, all: false};
  const isSmall = step => step !== advice.first && Math.abs(gainOf(step)) < kFolded;
  const effective = board.changes.filter(step => hasEffect(step, board));
  const listed = () => effective.filter(step => !(state.keep && step.changes_disparities));
  const fold = button('', () => {
    state.all = !state.all;
    chart.redraw();
  }, {id: 'fold-changes'});
  const rowOf = step => {
    const price = priceOf(step, board);
    const gain = gainText(gainOf(step)) + (gainOf(step) !== 0 && isWithin(step, board) ? ' ~' : '');
    return {
      name: stepText(step) + (step.changes_disparities ? ' *' : '') + (step.loses_pixels ? ' †' : ''),
      strong: step === advice.first,
      bars: [{
        from: now,
        to: step.frames_per_second,
        colour: step.frames_per_second > now ? '--blue' : '--vermilion',
        lines: [
          stepText(step),
          `${rate(step.frames_per_second)} frames/s, ${kind} (${gain})${lossText(step.loses_pixels)}`,
          `takes ${priceText(step, board)}`,
          `${signed(step.memory_mj_changed_percent, n => fixed(n, 1))} % energy of a frame, memories alone`,
          step.changes_disparities && 'changes the disparities',
          ...step.sets.map(set => `--set '${set}'`)
        ].filter(Boolean)
      }],
      texts: [
        gain, ...[price.slices, price.blockRams].map(each => each ? signed(each, whole) : '0'),
        newPartsOf(step).join(', ') || 'none'
      ]
    };
  };
  const draw = (host, width) => {
    const small = listed().filter(isSmall).length;
    const one = small === 1 ? 's' : '';
    fold.hidden = small === 0;
    fold.setAttribute('aria-expanded', String(state.all));
    fold.textContent =
        `${state.all ? '▾' : '▸'} ${count(small, 'change')} that gain${one} or lose${one} less than 0.1 %`;
    const above = width <= kWide;
    const rows = listed().filter(step => state.all || !isSmall(step)).map(rowOf);
    if (above) rows.forEach(row => row.texts.splice(1));
    const rates = [now, ...listed().map(step => step.frames_per_second)].filter(each => each > 0);
    const domain = [Math.min(...rates) * 0.95, Math.max(...rates) * 1.05];
    for (const {bars: [bar]} of rows) bar.to = Math.max(bar.to, domain[0]);
    drawBars(host, {
      rows,
      domain,
      isLog: true,
      axis: `frames/s, ${kind} (logarithmic)`,
      now: {value: now, text: `now: ${rate(now)}, ${kind}${board.loses_pixels ? ' †' : ''}`},
      heads: ['', 'slices', 'block RAMs', 'new parts'],
      above
    });
  };
  const keep = checkBox('keep-disparities', 'only what keeps the disparities', checked => {
    state.keep = checked;
    chart.redraw();
  });
  const without = [...new Set(board.changes.map(step => step.key))].filter(
      key => !effective.some(step => step.key === key));
  const chart = addChart(page, {
    id: 'knobs',
    wide: true,
    draw,
    title: (board.interrupted ? `Interrupted: ${board.interrupted}. ` : '') +
        (advice.first ? `First: ${stepText(advice.first)}, ${gainText(gainOf(advice.first))}` :
                         'No single change is worth making first'),
    note: `One setting changed at a time, simulated with ${
              count(board.frames, 'frame')} each. Right: the gain, and what the change takes in ` +
        'addition. First: the largest gain that needs nothing new; if there is none, the largest of ' +
        'all; where captures lose pixels, the best change that ends that. *: changes the disparities. ' +
        '†: captures lose pixels. ~: within the uncertainty.',
    body: [
      keep, note(without.length > 0 && `Without effect here: ${without.join(', ')}.`),
      impossible.length > 0 &&
          folded(
              `${count(impossible.length, 'change')} ${impossible.length === 1 ? 'is' : 'are'} not possible`,
              h('ul', {class: 'note'},
                impossible.map(step => h('li', null, `${stepText(step)}: ${step.reason}`))))
    ],
    foot: fold,
    numbers: () => [
        [
          'knob', 'from', 'to', 'frames_per_second', 'gain_percent', 'slices', 'block_rams', 'multipliers',
          'banks_used', 'new_banks', 'changes_disparities', 'loses_pixels', 'memory_mj_per_frame', 'sets'
        ],
        board.changes.map(
            step =>
                [step.key, step.from, step.to, step.frames_per_second, step.gained_percent,
                 step.area.slices, step.area.block_rams, step.area.multipliers, step.banks_used,
                 step.new_banks, String(step.changes_disparities), String(step.loses_pixels),
                 step.memory_mj_per_frame, step.sets.join(' ')])]
  });
}

// What the core takes of its FPGA, part by part.
export function addArea(page, run) {
  const {device, ...total} = run.area;
  const parts =
      run.area.parts.map(part => ({...part, lut_equivalents: Math.max(part.luts, part.flip_flops)}));
  const all = sum(parts.map(part => part.lut_equivalents));
  const rowOf = part => ({
    name: part.count > 1 ? `${part.name} × ${whole(part.count)}` : part.name,
    bars: [{
      to: part.lut_equivalents,
      colour: '--blue',
      lines: [
        `${part.name}: ${percent(part.lut_equivalents / all)} of the logic`,
        `${whole(part.luts)} LUTs, ${whole(part.flip_flops)} flip-flops`,
        `${whole(part.block_rams)} block RAMs, ${whole(part.multipliers)} multipliers`
      ]
    }],
    texts: [percent(part.lut_equivalents / all), part.block_rams > 0 ? `${part.block_rams} RAM` : '']
  });
  const use = (name, number, of) =>
      h('span', null, `${name} ${whole(number)} of ${whole(of)} `,
        h('meter', {value: number / of, 'aria-label': name}), ` ${fixed(100 * number / of, 1)} %`);
  addChart(page, {
    id: 'area',
    wide: true,
    draw: host => drawBars(host, {
      rows: [...parts].sort((a, b) => b.lut_equivalents - a.lut_equivalents).map(rowOf),
      domain: [0, most(parts.map(part => part.lut_equivalents))]
    }),
    title: `${fixed(total.slices_percent, 1)} % of the ${device.name}: ${whole(total.slices)} slices${
        total.fits ? '' : ', which does not fit'}`,
    note: 'An estimate: nothing is placed or routed. Bars: share of the logic, by the larger of a part\'s ' +
        'LUTs and flip-flops.',
    body:
        h('div', {class: 'uses'}, use('slices', total.slices, device.slices),
          use('block RAMs', total.block_rams, device.block_rams),
          use('multipliers', total.multipliers, device.multipliers)),
    numbers: () => {
      const names = ['count', 'luts', 'flip_flops', 'block_rams', 'multipliers', 'lut_equivalents'];
      return [['part', ...names], parts.map(part => [part.name, ...names.map(name => part[name])])];
    }
  });
}
