// What a run shows, in plain words: what limits, who waits for whom, where, what to change first, its price.
import {count, fixed, percent, rate, signed, sum, whole} from './format.js';
import {adviceOf, priceText, stepText} from './advice.js';
import {linesOf, rowsText, tilesOf} from './recording.js';

const kLeastShare = 0.0005;  // of all cycles that a port waits, to be named
const kFewTiles = 0.35;      // a share of the tiles that is named if it holds half of the stalls
const kAbout = 1 + 1e-6;     // a rate that reaches its bound may be above it by rounding

export const settingOf = (run, key) => run.settings.find(setting => setting.key === key)?.value;

// The rate of a run and its bound. The bound of a computer is that of the rate from power-up; of a few frames
// the steady rate may be above it, and is then not compared with it.
export function rateOf(run) {
  const {frames_per_second: rates, bound} = run.stats;
  const computer = rates.system !== undefined;
  const limit = computer ? bound.system : bound.core;
  const steady = rates.steady <= limit * kAbout;
  const now = steady ? rates.steady : rates.system ?? rates.core;
  const by = computer ? bound.system_limited_by : bound.core_limited_by;
  return {now, limit, by, computer, share: now / limit, steady};
}

// Stalls of the ports, the most first: {port, bank, by, cycles, share of all cycles}.
export const blamesOf = run => run.stats.blame.map(row => ({...row, share: row.cycles / run.stats.cycles}))
                                   .sort((a, b) => b.cycles - a.cycles);

export const waitText = ({port, bank, by, share}) => by === 'turnaround' ?
    `${port} waits ${percent(share)} of all cycles, while ${bank} turns round` :
    `${port} waits ${percent(share)} of all cycles, for ${by}, on ${bank}`;

const lostPixels = run => sum((run.stats.cameras ?? []).map(camera => camera.dropped_pixels));

function whatLimits(run) {
  const {by, limit, share, now, computer} = rateOf(run);
  const [kind, name] = by.split(' ');
  const reached = `The run reaches ${percent(share)} of the bound of ${rate(limit)} frames/s`;
  const because = {
    bank: () => {
      const bank = run.banks.find(each => each.name === name);
      const busy = run.stats.banks.find(each => each.name === name);
      return `Bank ${name} holds ${bank.buffers.map(each => each.name).join(', ')}, and is busy in ` +
          `${percent(busy.utilization)} of the cycles`;
    },
    port: () => `Port ${name}: it moves one word a cycle at most`,
    matcher: () =>
        'The matcher: it takes one pixel of each picture a cycle at most, and needs each pixel of ' +
        'a window',
    camera: () => 'The cameras: the board could do more',
    pci: () => 'The PCI bus: the words of pictures and results fill it',
    bridge: () => 'The local bus behind the bridge',
  }[kind]?.() ??
      by;
  const lost = [];
  if (computer && share < 0.995) {
    const dropped = run.stats.cameras?.[0];
    if (dropped?.dropped_not_armed > 0) {
      lost.push(
          `A capture begins with a camera frame: ${dropped.dropped_not_armed} of ${dropped.frames} frames ` +
          'of the camera found no free buffer');
    }
  }
  if (!computer && share < 0.99 && run.stats.blame.length === 0) {
    lost.push('no port stalls: the matcher waits for the queue of results, which no bound counts');
  }
  return [
    `${because}.`, `${reached}: ${rate(now)}.${lost.length ? ` ${lost.join('; ')}.` : ''}`,
    lostPixels(run) > 0 &&
        `Captures lose ${whole(lostPixels(run))} pixels: their FIFOs are full before the ` +
            'words reach the memory. Disparities there are wrong.'
  ];
}

function whoWaits(run) {
  const blames = blamesOf(run);
  if (blames.length > 0 && blames[0].share < kLeastShare) {
    const all = sum(blames.map(row => row.cycles));
    return [`Hardly anybody: all ports together wait ${count(all, 'cycle')} of ${whole(run.stats.cycles)}.`];
  }
  if (blames.length === 0) return ['Nobody: no port of the banks ever stalls.'];
  const others =
      blames.slice(1, 3).map(row => `${row.port} for ${row.by} on ${row.bank} (${percent(row.share)})`);
  return [
    `${waitText(blames[0])}.`,
    others.length > 0 ? `Then ${others.join(', ')}${blames.length > 3 ? ' and less' : ''}.` : null
  ];
}

// The first and the last of the amounts that hold all but 1 %, half of it at each end.
function mainPart(amounts) {
  const total = sum(amounts);
  let first = 0;
  for (let below = amounts[0]; below < 0.005 * total; below += amounts[++first])
    ;
  let last = amounts.length - 1;
  for (let above = amounts[last]; above < 0.005 * total; above += amounts[--last])
    ;
  return {first, last, total};
}

// Which columns hold the stalls, and whether few tiles hold many.
function acrossText(run) {
  const [{columns, width, values, total}] = tilesOf(run);
  const amounts = new Array(columns).fill(0);
  values.forEach((value, i) => {
    amounts[i % columns] += value;
  });
  const {first, last} = mainPart(amounts);
  const lastColumn = Math.min((last + 1) * width, settingOf(run, 'image.width')) - 1;
  const where = first === 0 && last === columns - 1 ? 'Over all columns' :
                                                      `In columns ${first * width} to ${lastColumn}`;
  const order = [...values].sort((x, y) => y - x);
  let tiles = 0;
  for (let rest = total / 2; rest > 0; ++tiles) rest -= order[tiles];
  const share = tiles / values.length;
  return `${where}${share < kFewTiles ? `; half of them in ${percent(share, 0)} of the picture` : ''}.`;
}

// Where in the picture the stalls are.
export function whereText(run) {
  const recorded = linesOf(run);
  if (!recorded) return ['Not known: this report was made with --quick, of a run without --record.'];
  const {lines, height, frames, stalls} = recorded;
  const amounts = Array.from({length: lines}, (_, line) => sum(stalls.map(({values}) => values[line])));
  if (sum(amounts) === 0)
    return [
      stalls.length ? 'Nowhere: ports wait only before the first row.' :
                      'Nowhere: no row of the picture waits.'
    ];
  const imageHeight = settingOf(run, 'image.height');
  const {first, last, total} = mainPart(amounts);
  const mean = total / frames / (last + 1 - first) / height;
  const tenth = Math.max(1, Math.round(lines / 10));
  let best = {sum: 0, line: 0};
  for (let line = 0, window = 0; line < lines; ++line) {
    window += amounts[line] - (line >= tenth ? amounts[line - tenth] : 0);
    if (window > best.sum) best = {sum: window, line: Math.max(0, line - tenth + 1)};
  }
  const uneven = best.sum / total > 2 * tenth / (last + 1 - first);
  const texts = [
    uneven ? `Most in ${rowsText(recorded, best.line, best.line + tenth, imageHeight)}: ${
                 percent(best.sum / total, 0)} of all stalls.` :
             `${rowsText(recorded, first, last + 1, imageHeight).replace(/^r/, 'R')} of ${
                 imageHeight}, evenly: ${whole(mean)} stall cycles a row and frame.`,
    acrossText(run)
  ];
  const cycles = run.stats.frame_cycles;
  const least = cycles.reduce((a, b) => Math.min(a, b));
  const most = cycles.reduce((a, b) => Math.max(a, b));
  const longer = cycles.filter(each => each > 1.01 * least).length;
  if (longer > 0) {
    texts.push(`In ${longer} of ${count(cycles.length, 'frame')}: these take up to ${
        whole(most)} cycles, the others ${whole(least)}.`);
  }
  return texts;
}

function whatFirst(run) {
  const advice = adviceOf(run);
  if (!advice) return ['Not known: this report was made with --quick.'];
  const {first, largest, gain, isCheap, cures} = advice;
  if (!first) return ['Nothing in one step: no knob gains 1 % or more and keeps the disparities.'];
  const text = step => `${stepText(step)} gives ${rate(step.frames_per_second)} frames/s (${
      signed(gain(step), percent)})${step.loses_pixels ? ', and loses pixels too' : ''}`;
  return [
    `${text(first)}${isCheap ? ', with the FPGA and the banks there are' : ''}${
        cures ? ', and loses no pixels' : ''}.`,
    largest === first ? null : `The largest step: ${text(largest)}.`
  ];
}

function whatItCosts(run) {
  const {total, device} = run.area;
  const advice = adviceOf(run);
  const now = `The board takes ${whole(total.slices)} slices (${fixed(total.slices_percent, 1)} % of the ` +
      `${device.name}) and ${count(total.block_rams, 'block RAM')}.`;
  if (!advice?.first) return [now];
  const texts = [`The first change takes ${priceText(advice.first, advice.board)}.`];
  if (advice.largest !== advice.first)
    texts.push(`The largest takes ${priceText(advice.largest, advice.board)}.`);
  return [...texts, now];
}

export function headlineOf(run) {
  const {now, limit, by, share, steady, computer} = rateOf(run);
  return `${rate(now)} frames/s${
             steady       ? ', steady' :
                 computer ? ' from power-up' :
                            ''}: ${percent(share)} of the bound ` +
      `${rate(limit)}, which ${by.replace(/^(bank|port) /, '').replace('matcher', 'the matcher')} sets` +
      (lostPixels(run) > 0 ? '. Captures lose pixels' : '');
}

// [question, [answer, ..]] in the order in which they are asked.
export const answersOf = run => [
    ['What limits?', whatLimits(run)],
    ['Who waits for whom?', whoWaits(run)],
    ['Where in the picture?', whereText(run)],
    ['What to change first?', whatFirst(run)],
    ['What does it cost?', whatItCosts(run)],
];
