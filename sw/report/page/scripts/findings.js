// What a run shows, in plain words: what limits, who waits for whom, where, what to change first, its price.
import {adviceOf, gainOf, priceText, stepText} from './advice.js';
import {linesOf, rowsText, tilesOf} from './data.js';
import {
    bankText, capital, count, fixed, gainText, grouped, kRates, lossText, percent, rate, rateWith, sum, whole
} from './format.js';

const kLeastShare = 0.0005;  // of all cycles that a port waits, to be named
const kFewTiles = 0.35;      // a share of the tiles that is named if it holds half of the waits
const kMostCauses = 3;       // of a port that are named

export const settingOf = (run, key) => run.settings.find(setting => setting.key === key)?.value;

// The first kind of rate that all these runs have: [name in stats.json, kind].
export const kindOfRate = (...runs) =>
    kRates.find(([name]) => runs.every(run => run.stats.frames_per_second[name] !== undefined));

export const lostPixels = run => sum((run.stats.cameras ?? []).map(camera => camera.dropped_pixels));

// The rate of a run, what kind of rate it is, its bound, and the pixels that it loses.
export function rateOf(run) {
  const {frames_per_second: rates, bound} = run.stats;
  const computer = rates.system !== undefined;
  const limit = computer ? bound.system : bound.core;
  const [name, kind] = kindOfRate(run);
  const now = rates[name];
  const by = computer ? bound.system_limited_by : bound.core_limited_by;
  const lost = lostPixels(run);
  const text = `${rateWith(now, rates.steady_uncertainty)} frames/s, ${kind}${lossText(lost)}`;
  return {now, text, kind, limit, by, lost};
}

// How near a rate is to the bound that a resource sets.
export function againstBound({now, kind, lost}, limit, by) {
  const bound = `the bound of ${rate(limit)} frames/s, which ${withVerb(by, 'set')}`;
  if (lost > 0) return `not to be compared with ${bound} for whole pictures`;
  if (rate(now) === rate(limit)) return `at ${bound}`;
  if (now <= limit) return `${percent(now / limit)} of ${bound}`;
  return kind === 'steady' ? `at ${bound}, within its uncertainty` : `above ${bound} over whole turns`;
}

// The kind of the rates of single changes.
export const kindOfSteps = run => run.stats.cameras ? 'steady' : 'core only';

const kResources = {
  matcher: 'the matcher',
  camera: 'the cameras',
  pci: 'the PCI bus',
  bridge: 'the PCI bridge'
};
export const resourceText = name => kResources[name] ??
    (name.startsWith('bank ') ? bankText(name.slice(5)) : name.replace(/^port /, ''));
// "bank2 sets", "the cameras set"
export const withVerb = (name, verb) => `${resourceText(name)} ${verb}${name === 'camera' ? '' : 's'}`;

// Waits of the ports by bank and cause, the most first: {port, bank, by, cycles, share of all cycles}.
export const blamesOf = run => run.stats.blame.map(row => ({...row, share: row.cycles / run.stats.cycles}))
                                   .sort((a, b) => b.cycles - a.cycles);

// The same, with what the host moved as its name, if all frames were recorded.
export function blamesInDetail(run) {
  const recorded = linesOf(run);
  if (!recorded || recorded.frames !== run.stats.frame_cycles.length) return blamesOf(run);
  return recorded.stalls.map(
      ({port, bank, by, total}) => ({port, bank, by, cycles: total, share: total / run.stats.cycles}));
}

const kCauses = {turnaround: 'the turnaround', row: 'a row to open', refresh: 'a refresh'};
const causeText = by => `for ${kCauses[by] ?? by}`;

export const blameText = ({port, bank, by, share}) =>
    `${port} waits in ${percent(share)} of all cycles, ${causeText(by)} on ${bankText(bank)}`;

// The ports that wait, the most first: {port, cycles, share, causes: its waits, the most first}.
export function waitsOf(run) {
  const ports = new Map();
  for (const row of blamesInDetail(run)) {
    if (!ports.has(row.port)) ports.set(row.port, {port: row.port, cycles: 0, share: 0, causes: []});
    const port = ports.get(row.port);
    port.cycles += row.cycles;
    port.share += row.share;
    port.causes.push(row);
  }
  return [...ports.values()].sort((a, b) => b.cycles - a.cycles);
}

export function waitText({port, share, causes}) {
  if (causes.length === 1) return blameText(causes[0]);
  const isOneBank = causes.every(({bank}) => bank === causes[0].bank);
  const named = causes.slice(0, kMostCauses).filter((cause, i) => i === 0 || cause.share >= kLeastShare);
  const texts = named.map(
      ({bank, by, share: part}) =>
          `${percent(part)} ${causeText(by)}${isOneBank ? '' : ` on ${bankText(bank)}`}`);
  return `${port} waits in ${percent(share)} of all cycles: ${texts.join(', ')}${
      named.length < causes.length ? ' and less' : ''}${isOneBank ? `, on ${bankText(causes[0].bank)}` : ''}`;
}

function whatLimits(run) {
  const {limited_by: limiter, frames} = run.knobs ?? {};
  return [
    limiter ? `Limited by ${grouped(limiter)}.` : 'Not known with --quick: only how far the lowest bound is.',
    limiter && rateOf(run).kind !== kindOfSteps(run) && `That is steady, of ${whole(frames)} frames.`,
    `${headlineOf(run)}.`, run.stats.cameras && droppedText(run),
    lostPixels(run) > 0 && 'Pixels are lost where a capture FIFO is full. Disparities there are wrong.'
  ];
}

// How many frames of the left camera are dropped, and why.
export function droppedText(run) {
  const camera = run.stats.cameras[0];
  const reasons = [
    [camera.dropped_not_armed, 'its capture board is not armed as they begin'],
    [camera.dropped_busy, 'the capture before them still runs'],
    [camera.dropped_by_partner, 'the other board cannot take them']
  ].filter(([amount]) => amount > 0);
  if (reasons.length === 0) return null;
  return [
    `${whole(camera.dropped_frames)} of ${count(camera.frames, 'frame')} of the left camera ${
        camera.dropped_frames === 1 ? 'is' : 'are'} dropped: ${
        reasons.map(([amount, text]) => `${whole(amount)} because ${text}`).join(', ')}.`,
    settingOf(run, 'cameras.trigger') === 'free_running' &&
        `The cameras deliver ${rate(settingOf(run, 'cameras.frame_rate_hz'))} frames/s; the run makes ${
            rateOf(run).text}.`,
    camera.dropped_not_armed > 0 &&
        'A capture board is armed when the tables are uploaded and a buffer is free.'
  ].filter(Boolean).join(' ');
}

function whoWaits(run) {
  const waits = waitsOf(run);
  if (waits.length === 0) return ['Nobody: no port of the banks ever waits.'];
  if (waits[0].share < kLeastShare) {
    const all = sum(waits.map(row => row.cycles));
    return [`Hardly anybody: all ports together wait ${count(all, 'cycle')} of ${whole(run.stats.cycles)}.`];
  }
  const placeText = ({by, bank}) => `${causeText(by)} on ${bankText(bank)}`;
  const others = waits.slice(1, 3).map(
      ({port, share, causes}) =>
          `${port} ${percent(share)}, ${causes.length === 1 ? '' : 'mostly '}${placeText(causes[0])}`);
  return [
    `${waitText(waits[0])}.`,
    others.length > 0 ? `Then ${others.join('; ')}${waits.length > 3 ? '; others less' : ''}.` : null
  ];
}

// The indices of the first and the last amount of the main part. Each end leaves out less than 0.5 % of the
// total, and only amounts below half of the mean.
function mainPart(amounts) {
  const total = sum(amounts);
  const little = total / amounts.length / 2;
  const edgeOf = some => some.findIndex(
      (amount, i) => amount >= little || sum(some.slice(0, i + 1)) >= 0.005 * total);
  return {first: edgeOf(amounts), last: amounts.length - 1 - edgeOf([...amounts].reverse()), total};
}

// Which columns hold the waits, and whether few tiles hold many.
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
  return `${where}${
      share < kFewTiles ? `; half of all waits are in ${percent(share, 0)} of the picture` : ''}.`;
}

// The consecutive lines with the largest surplus over `mean`: {from, to, sum}.
function densestLines(amounts, mean) {
  let best = {surplus: 0, from: 0, to: 0};
  for (let line = 0, from = 0, surplus = 0; line < amounts.length; ++line) {
    if (surplus <= 0) [from, surplus] = [line, 0];
    surplus += amounts[line] - mean;
    if (surplus > best.surplus) best = {surplus, from, to: line + 1};
  }
  return {...best, sum: sum(amounts.slice(best.from, best.to))};
}

// The rows in which ports wait: "most often in rows 0 to 9: ..". null if they wait in none.
export function waitingRows(run) {
  const recorded = linesOf(run);
  const {lines, height, frames, stalls} = recorded;
  const amounts = Array.from({length: lines}, (_, line) => sum(stalls.map(({values}) => values[line])));
  if (sum(amounts) === 0) return null;
  const imageHeight = settingOf(run, 'image.height');
  const {first, last, total} = mainPart(amounts);
  const waiting = last + 1 - first;
  const waits = sum(amounts.slice(first, last + 1));
  const densest = densestLines(amounts, waits / waiting);
  if (densest.sum / total > 2 * (densest.to - densest.from) / waiting) {
    return `most often in ${rowsText(recorded, densest.from, densest.to, imageHeight)}: ${
        percent(
            densest.sum / total,
            0)} of all waits in ${percent((densest.to - densest.from) / lines, 0)} of the rows`;
  }
  const rows = Math.min((last + 1) * height, imageHeight) - first * height;
  return `in ${rowsText(recorded, first, last + 1, imageHeight)} of ${imageHeight}, evenly: ${
      whole(waits / frames / rows)} cycles of waiting a row and frame`;
}

// Where in the picture ports wait.
function whereText(run) {
  const recorded = linesOf(run);
  if (!recorded) return ['Not known: this report was made with --quick, of a run without --record.'];
  const rows = waitingRows(run);
  if (!rows) {
    return [
      recorded.stalls.length ? 'Nowhere: ports wait only before the first row.' :
                               'Nowhere: no row of the picture waits.'
    ];
  }
  const texts = [`${capital(rows)}.`, acrossText(run)];
  const cycles = run.stats.frame_cycles;
  const least = cycles.reduce((a, b) => Math.min(a, b));
  const most = cycles.reduce((a, b) => Math.max(a, b));
  const longer = cycles.filter(each => each > 1.01 * least).length;
  if (longer > 0) {
    texts.push(`${longer} of ${count(cycles.length, 'frame')} ${longer === 1 ? 'takes' : 'take up to'} ${
        whole(most)} cycles; the shortest takes ${whole(least)}.`);
  }
  return texts;
}

function whatFirst(run) {
  const advice = adviceOf(run);
  if (!advice) return ['Not known: this report was made with --quick.'];
  const {first, largest, board} = advice;
  const rateText = step =>
      `${rateWith(step.frames_per_second, step.uncertainty_frames_per_second)} frames/s, ${kindOfSteps(run)}`;
  const now = `Now: ${rateText(board)}${lossText(board.loses_pixels)}.`;
  const rule = 'Named are only changes that keep the disparities and lose no pixels, that fit the FPGA, ' +
      'and that gain at least 1 % and more than the uncertainty' +
      `${board.loses_pixels ? ', or end the loss' : ''}.`;
  const others = board.interrupted && `Interrupted: ${board.interrupted}. Others may be better.`;
  const none = others || (board.loses_pixels ? 'None of the changes ends the loss of pixels.' : 'Nothing.');
  if (!first) return [none, now, rule];
  const text = step => `${stepText(step)} gives ${rateText(step)} (${gainText(gainOf(step))})`;
  const sets = step => step.sets.map(set => `--set '${set}'`).join(' ');
  return [
    `${text(first)}${board.loses_pixels ? ', and loses no pixels' : ''}.`, now,
    `To try it: ${sets(first)}.`, rule, others,
    largest && largest !== first &&
        `The largest gain: ${text(largest)}. It needs ${priceText(largest, board)}.`
  ];
}

function whatItCosts(run) {
  const {device, ...total} = run.area;
  const advice = adviceOf(run);
  const now =
      `The core as it is takes ${whole(total.slices)} slices (${fixed(total.slices_percent, 1)} % of the ` +
      `${device.name}) and ${count(total.block_rams, 'block RAM')}.`;
  if (!advice?.first) return [now];
  return [`The first change takes ${priceText(advice.first, advice.board)}.`, now];
}

export function headlineOf(run) {
  const its = rateOf(run);
  return `${its.text}: ${againstBound(its, its.limit, its.by)}`;
}

// [question, [answer, ..]] in the order in which they are asked.
export const answersOf = run => [
    ['What limits?', whatLimits(run)],
    ['Who waits for whom?', whoWaits(run)],
    ['Where in the picture?', whereText(run)],
    ['What to change first?', whatFirst(run)],
    ['What does it cost?', whatItCosts(run)],
];
