// What limits a run: the bounds of its resources, the roofline of its busiest bank, what ports and banks do
// in all cycles, and how long its frames take.
import {adviceOf, hasEffect, stepText} from './advice.js';
import {drawBars, drawColumns} from './bars.js';
import {addChart, legend} from './card.js';
import {s} from './dom.js';
import {againstBound, kindOfSteps, rateOf, resourceText, settingOf, withVerb} from './findings.js';
import {bankText, fixed, inMs, least, lossText, most, percent, rate, tableOf, whole} from './format.js';
import {axisBelow, axisLeft, cut, drawing, numeric} from './plot.js';
import {mark} from './tooltip.js';

const kMostFrames = 200;

// Each resource with the frame in which it allows least.
function resourcesOf(run) {
  const clock = 1e6 * settingOf(run, 'fpga.clock_mhz');
  const all = new Map();
  run.bounds.core.forEach((resources, frame) => resources.forEach(({resource, cycles}) => {
    if (run.bounds.computer && resource.startsWith('bank ')) return;  // there with the accesses of the host
    const known = all.get(resource);
    if (!known || cycles > known.cycles)
      all.set(resource, {resource, cycles, frame, frames_per_second: clock / cycles});
  }));
  return [...all.values(), ...run.bounds.computer ?? []].sort(
      (a, b) => a.frames_per_second - b.frames_per_second);
}

// The ladder of bounds: what each resource alone would allow, beside what the run reaches.
export function addBounds(page, run) {
  const its = rateOf(run);
  const {now, kind, limit, by, lost} = its;
  const resources = resourcesOf(run);
  const lowest = resources[0].frames_per_second;
  const turn = run.bounds.core.length;
  // The bound is a mean over frames that differ.
  const isMean = limit > lowest * 1.001;
  const rowOf = each => ({
    name: resourceText(each.resource).replace(/^the /, ''),
    strong: each.resource === by,
    bars: [{
      to: each.frames_per_second,
      dot: true,
      colour: each.resource === by ? '--vermilion' : '--blue',
      lines: [
        `${each.resource}: at most ${rate(each.frames_per_second)} frames/s`,
        each.cycles &&
            `${whole(each.cycles)} cycles a frame${
                turn > 1 ? `, in frame ${each.frame} of each ${turn}` : ''}`,
        turn > 1 && each.cycles ?
            `frame ${each.frame} of the run takes ${whole(run.stats.frame_cycles[each.frame])} cycles` :
            `the run: ${againstBound(its, each.frames_per_second, each.resource)}`
      ].filter(Boolean)
    }],
    texts: [rate(each.frames_per_second)]
  });
  addChart(page, {
    id: 'bounds',
    title: `${withVerb(by, 'set')} the bound of ${rate(limit)} frames/s`.replace(/^the /, 'The '),
    draw: host => drawBars(host, {
      rows: resources.map(rowOf),
      domain: [Math.min(now, lowest) * 0.8, Math.max(resources.at(-1).frames_per_second, now) * 1.1],
      isLog: true,
      axis: 'frames/s (logarithmic)',
      now: {value: now, text: `the run: ${rate(now)}, ${kind}${lost > 0 ? ', losing pixels' : ''}`}
    }),
    note: 'The frames a second that each resource alone would allow' +
        (run.bounds.computer ? '. Of banks and buses all masters count.' : '.') +
        (isMean ?
             ` Frames differ: a resource has the frame in which it allows least, and the bound is the mean ${
                 turn > 1 ? `over ${turn} frames` : 'over all frames'} of the slowest resource of each.` :
                            ''),
    numbers: () => tableOf(['resource', 'frames_per_second', 'cycles', 'frame'], resources)
  });
}

// The roofline: how often the busiest bank is accessed for a pixel, against pixels a second.
export function addRoofline(page, run) {
  if (!run.knobs) return;
  const board = run.knobs;
  const kind = kindOfSteps(run);
  const {first, largest} = adviceOf(run);
  const pixels = settingOf(run, 'image.width') * settingOf(run, 'image.height');
  const point = (step, name) => ({
    ...step,
    step,
    board: name,
    bank: step.busiest_bank.name,
    accesses_per_pixel: step.busiest_bank.accesses_per_pixel,
    megapixels_per_second: step.frames_per_second * pixels / 1e6
  });
  const here = point(board, 'this board');
  const all = board.changes.filter(step => hasEffect(step, board))
                  .map(step => point(step, stepText(step)))
                  .filter(each => each.accesses_per_pixel > 0);
  const roofAt = here.clock_mhz / here.accesses_per_pixel;
  const share = here.megapixels_per_second / roofAt;
  const isNamed = ({step}) => step === first || step === largest;
  const linesOf = each =>
      [each.board, `${fixed(each.accesses_per_pixel, 2)} accesses of ${bankText(each.bank)} a pixel`,
       `${fixed(each.megapixels_per_second, 2)} Mpixels/s, ` +
           `${rate(each.frames_per_second)} frames/s, ${kind}${lossText(each.loses_pixels)}`];
  const draw = (host, width) => {
    const {plot, width: inner, height} = drawing(
        host, width, Math.min(380, Math.max(280, width * 0.6)), {left: 46, right: 14, top: 24, bottom: 40},
        'Roofline');
    const xs = [here, ...all].map(each => each.accesses_per_pixel);
    const ys = [here, ...all].map(each => each.megapixels_per_second).filter(each => each > 0);
    const x = numeric([Math.min(...xs) * 0.8, Math.max(...xs) * 1.25], [0, inner], true);
    const y = numeric([Math.min(...ys) * 0.8, Math.max(...ys, roofAt) * 1.3], [height, 0], true);
    const roof = [Math.max(x.domain[0], here.clock_mhz / y.domain[1]),
                  Math.min(x.domain[1], here.clock_mhz / y.domain[0])].map(
        each => [x(each), y(here.clock_mhz / each)]);
    const dot = (each, attributes, lines) => {
      const place = {cx: x(each.accesses_per_pixel), cy: y(each.megapixels_per_second)};
      return mark(s('circle', {...place, ...attributes}), lines);
    };
    plot.append(
        axisBelow(x, inner, height, 'accesses of the busiest bank for a pixel (logarithmic)'),
        axisLeft(y, inner, height),
        s('text', {x: -6, y: -10, class: 'label left'}, 'Mpixels/s (logarithmic)'),
        s('polyline', {points: roof.join(' '), class: 'roof'}),
        ...[...all]
            .sort((a, b) => isNamed(a) - isNamed(b))
            .map(each => dot(each, {r: isNamed(each) ? 7 : 4, class: 'neighbour'}, linesOf(each))),
        dot(here, {r: 7, style: 'fill:var(--vermilion)'},
            [...linesOf(here), `${percent(share)} of the roof`]));
    // The names of the large dots, each beside its dot where no other name is.
    const taken = [];
    for (const each of [here, ...all.filter(isNamed)]) {
      const [at, isLeft] = [x(each.accesses_per_pixel), x(each.accesses_per_pixel) > inner / 2];
      let below = y(each.megapixels_per_second) + 4;
      while (taken.some(other => Math.abs(other - below) < 15)) below += 15;
      taken.push(below);
      plot.append(
          s('text',
            {x: at + (isLeft ? -11 : 11), y: below, 'text-anchor': isLeft ? 'end' : 'start', class: 'halo'},
            cut(each.board, isLeft ? at - 11 : inner - at - 11)));
    }
    const label = `roof: ${bankText(here.bank)} at ${here.clock_mhz} MHz`;
    plot.append(
        s('text', {x: inner, y: -10, 'text-anchor': 'end', class: 'label halo'}, cut(label, inner - 150)));
  };
  addChart(page, {
    id: 'roofline',
    draw,
    title: `${bankText(here.bank)} works at ${percent(share)} of its roof${lossText(here.loses_pixels)}`,
    note:
        'The line is the roof: what a bank with one access a cycle allows. Both axes are logarithmic. ' +
        'Large dots: this board (orange), the first change and the largest gain. ' +
        'Small dots: all other single changes.',
    numbers: () => tableOf(
        ['board', 'bank', 'accesses_per_pixel', 'megapixels_per_second', 'frames_per_second', 'loses_pixels',
         'clock_mhz'],
        [here, ...all])
  });
}

const kPortStates = [
  ['grants', 'granted', '--blue'], ['stall_cycles', 'waits', '--vermilion'],
  ['passed_cycles', 'no access needed', '--sky'], ['blocked_cycles', 'output full', '--yellow'],
  ['starved_cycles', 'no input', '--green'], ['idle_cycles', 'idle', '--pale']
];
const kBankStates = [
  ['busy_cycles', 'busy', '--blue'], ['turnaround_cycles', 'turnaround', '--grey'],
  ['row_cycles', 'a row opens', '--vermilion'], ['refresh_cycles', 'refresh', '--yellow'],
  ['idle_cycles', 'idle', '--pale']
];

// Bars that add up to all cycles of the frames.
function addStates(
    page, {id, title, note, items, states: all, cycles, textOf = name => name, more = () => []}) {
  const states = all.filter(([key]) => items.some(item => item[key] !== undefined));
  const rowOf = item => {
    let end = 0;
    const bars = states.filter(([key]) => item[key] > 0)
                     .map(([key, name, colour]) => ({
                            from: end,
                            to: end += item[key],
                            colour,
                            lines: [
                              `${textOf(item.name)}: ${name} ${percent(item[key] / cycles, 2)}`,
                              `${whole(item[key])} cycles`, ...more(item)
                            ]
                          }));
    return {name: textOf(item.name), bars, texts: [percent(item[states[0][0]] / cycles)]};
  };
  addChart(page, {
    id,
    title,
    note,
    draw: host => drawBars(host, {rows: items.map(rowOf), domain: [0, cycles]}),
    body: legend(states.map(([, name, colour]) => [name, `var(${colour})`])),
    numbers: () => tableOf(['name', ...states.map(([key]) => key)], items)
  });
}

export function addPortStates(page, {stats}, suffix = '') {
  const worst = [...stats.ports].sort((a, b) => b.stall_cycles - a.stall_cycles)[0];
  addStates(page, {
    id: `ports${suffix && `-${suffix}`}`,
    items: stats.ports,
    states: kPortStates,
    cycles: stats.cycles,
    title: (suffix && `${suffix}: `) +
        (worst.stall_cycles > 0 ?
             `${worst.name} waits in ${percent(worst.stall_cycles / stats.cycles)} of the cycles` :
             'No port ever waits'),
    note:
        'What each port does in all cycles of the frames; on the right the share granted. No access ' +
        'needed: it has the word already, or the place is outside the picture. Output full: the queue ' +
        'behind it takes no more. No input: nothing to work on has come. Idle: before its first and after ' +
        'its last work of a frame; the host: no request.'
  });
}

export function addBankUse(page, {stats, banks}) {
  const busiest = [...stats.banks].sort((a, b) => b.utilization - a.utilization)[0];
  const unused = stats.banks.filter(bank => bank.busy_cycles === 0);
  addStates(page, {
    id: 'banks',
    items: stats.banks,
    states: kBankStates,
    cycles: stats.cycles,
    title: `${bankText(busiest.name)} is busy in ${percent(busiest.utilization)} of the cycles` +
        (unused.length === 0     ? '' :
             unused.length === 1 ? `; ${bankText(unused[0].name)} is never used` :
                                   `; ${unused.length} of ${stats.banks.length} banks are never used`),
    note: 'How busy each bank is in all cycles of the frames.',
    textOf: bankText,
    more: bank =>
        [`${whole(bank.reads)} reads, ${whole(bank.writes)} writes, ` +
             `in ${whole(bank.contended_cycles)} cycles a port waits`,
         banks.find(each => each.name === bank.name).buffers.join(', ') || 'holds nothing']
  });
}

// The cycles of each frame. series: [[name, [cycles, ..], colour], ..]
export function addFrames(page, series, clockMhz) {
  const frames = Math.max(...series.map(([, cycles]) => cycles.length));
  const all = series.flatMap(([, cycles]) => cycles);
  const [fewest, longest] = [least(all), most(all)];
  const shown = Math.min(frames, kMostFrames);
  const barsOf = frame =>
      series.filter(([, cycles]) => cycles[frame] !== undefined)
          .map(([name, cycles, colour]) => ({
                 parts: [[cycles[frame], colour]],
                 lines: [
                   `${name ? `${name}, ` : ''}frame ${frame}: ${whole(cycles[frame])} cycles`,
                   inMs(cycles[frame] / clockMhz * 1e6, 3)
                 ]
               }));
  addChart(page, {
    id: 'frames',
    draw: (host, width) => drawColumns(host, width, {
      groups: Array.from({length: shown}, (_, frame) => barsOf(frame)),
      label: 'Cycles of each frame',
      unit: 'cycles',
      below: `frame 0 to ${shown - 1}${shown < frames ? ` of ${whole(frames)}` : ''}`
    }),
    title: fewest === longest ?
        `${frames === 1 ? 'The frame' : `Each of ${frames} frames`} takes ${whole(fewest)} cycles` :
        `Frames take ${whole(fewest)} to ${whole(longest)} cycles`,
    note: 'Cycles of the FPGA clock from the start of a frame to its last result.',
    body: series.length > 1 && legend(series.map(([name, , colour]) => [name, `var(${colour})`])),
    numbers: () => [
        ['frame', ...series.map(([name]) => name || 'cycles')],
        Array.from(
            {length: frames}, (_, frame) => [frame, ...series.map(([, cycles]) => cycles[frame] ?? null)])]
  });
}
