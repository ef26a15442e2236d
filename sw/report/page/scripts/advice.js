// What to change first, of all single changes of the board, and what a change takes.
import {bankText, fixed, signed, whole} from './format.js';

const kWorthwhile = 0.01;  // least gain of a change worth naming, of the present rate
const kFreeSlices = 1;     // percent of the FPGA that a change may take and still need nothing new
const kSame = 0.9995;      // rates that differ by less are the same
const kVisible = 0.0005;  // frames/s

// Keys that are no settings of the parts of the board, but need another part.
const kNeeds = [
  [/^ssram\.banks\./, () => 'other memory chips'],
  [/^cameras\.frame_rate_hz$/, () => 'other cameras'],
  [/^capture\.fifo_words$/, () => 'other capture boards'],
  [/^pci\.load\./, () => 'other traffic on the PCI bus'],
  [/^pci\.(clock_mhz|width_bits)$/, () => 'another PCI bus'],
  [/^pci\.memory_wait_clocks$/, () => 'another host'],
  [/^(pci\.bridge_wait_clocks|bridge\.(posted_words|local_clock_mhz))$/, () => 'another PCI bridge'],
  [/^fpga\.clock_mhz$/, step => `a clock of ${step.clock_mhz} MHz`],
];

// The gain of a change, as a share of the present rate.
export const gainOf = step => step.gained_percent / 100;
// Whether a gain is within what the finite runs leave open of both rates.
export const isWithin = (step, board) => Math.abs(step.frames_per_second - board.frames_per_second) <=
    step.uncertainty_frames_per_second + board.uncertainty_frames_per_second;

// Whether a change has a visible effect: on the loss of pixels, or on the rate.
export const hasEffect = (step, board) => step.loses_pixels !== board.loses_pixels ||
    Math.abs(step.gained_frames_per_second) >= kVisible;

// A change in words: matcher.rows: 1 → 2.
export function stepText({key, from, to, idle_banks: idle}) {
  const moved = key === 'a bank more' && /^(.*) in (.*)$/.exec(from);
  return moved ? `${moved[1]}: ${moved[2]} → ${idle?.length ? bankText(idle[0]) : 'a new bank'}` :
                 `${key}: ${from} → ${to}`;
}

// What a change takes beside the board as it is.
export function priceOf(step, board) {
  return {
    slices: step.area.slices - board.area.slices,
    slicesPercent: step.area.slices_percent - board.area.slices_percent,
    blockRams: step.area.block_rams - board.area.block_rams,
    multipliers: step.area.multipliers - board.area.multipliers,
  };
}

// The parts that a change needs and the board does not have.
export function newPartsOf(step) {
  const parts = kNeeds.filter(([key]) => key.test(step.key)).map(([, text]) => text(step));
  if (step.new_banks > 0) parts.push(step.new_banks === 1 ? 'a new bank' : `${step.new_banks} new banks`);
  return parts;
}

export function priceText(step, board) {
  const price = priceOf(step, board);
  const parts = newPartsOf(step);
  const add = (number, noun) =>
      number && parts.push(`${signed(number, whole)} ${noun}${Math.abs(number) === 1 ? '' : 's'}`);
  if (price.slices) {
    add(price.slices, 'slice');
    parts[parts.length - 1] += ` (${signed(price.slicesPercent, n => fixed(n, 1))} % of the FPGA)`;
  }
  add(price.blockRams, 'block RAM');
  add(price.multipliers, 'multiplier');
  if (!step.area.fits) parts.push('a larger FPGA');
  if (parts.length === 0) parts.push('nothing new');
  const idle = step.idle_banks ?? [];
  return parts.join(', ') +
      (idle.length ?
           `: it uses ${idle.map(bankText).join(' and ')}, which ${
               idle.length === 1 ? 'holds' : 'hold'} nothing` :
           '');
}

// The changes worth naming: the largest gain of those that need nothing new, and the largest of all. Left out
// is what changes disparities, loses pixels, does not fit, gains within the uncertainty, or saves a bank.
export function adviceOf(run) {
  if (!run.knobs) return null;
  const board = run.knobs;
  const sound = board.changes.filter(
      step => !step.changes_disparities && !step.loses_pixels && step.area.fits &&
          step.key !== 'a bank less');
  const useful = sound.filter(step => gainOf(step) >= kWorthwhile && !isWithin(step, board));
  // Of a board that loses pixels, the best step that cures it comes first, whatever it gains or takes.
  const cure = board.loses_pixels && sound[0];
  const isFree = step => {
    const price = priceOf(step, board);
    return newPartsOf(step).length === 0 && price.slicesPercent <= kFreeSlices && price.blockRams <= 0 &&
        price.multipliers <= 0;
  };
  // Of changes in the order of their gains: the best, and of several that gain the same the smallest.
  const bestOf = some => some.filter(step => step.frames_per_second > some[0].frames_per_second * kSame)
                             .sort((a, b) => a.area.slices - b.area.slices)[0];
  const largest = bestOf(useful) ?? null;
  return {
    first: cure || (bestOf(useful.filter(isFree)) ?? largest),
    largest,
    board,
  };
}
