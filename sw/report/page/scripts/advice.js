// What to change first, of all steps of knobs, and what a step costs.
import {fixed, signed, whole} from './format.js';

const kWorthwhile = 0.01;  // least gain of a change worth naming, of the present rate
const kCheapSlices = 1;    // percent of the FPGA that a cheap change may take in addition

// What a step costs beside the board as it is.
export function priceOf(step, board) {
  return {
    slices: step.area.slices - board.area.slices,
    slicesPercent: step.area.slices_percent - board.area.slices_percent,
    blockRams: step.area.block_rams - board.area.block_rams,
    multipliers: step.area.multipliers - board.area.multipliers,
    banks: step.banks_used - board.banks_used,
  };
}

export function priceText(step, board) {
  const price = priceOf(step, board);
  const parts = [];
  if (price.slices)
    parts.push(`${signed(price.slices, whole)} slices (${
        signed(price.slicesPercent, n => fixed(n, 1))} % of the FPGA)`);
  if (price.blockRams) parts.push(`${signed(price.blockRams, whole)} block RAMs`);
  if (price.multipliers) parts.push(`${signed(price.multipliers, whole)} multipliers`);
  if (price.banks)
    parts.push(`${signed(price.banks, whole)} ${Math.abs(price.banks) === 1 ? 'bank' : 'banks'}`);
  if (step.clock_mhz !== board.clock_mhz) parts.push(`a clock of ${step.clock_mhz} MHz`);
  if (!step.area.fits) parts.push('it does not fit');
  return parts.length ? parts.join(', ') : 'nothing that is counted';
}

// The changes worth naming: the largest gain of those that are cheap, and the largest of all. Changes of the
// disparities, boards that lose pixels and boards that do not fit are left out.
export function adviceOf(run) {
  if (!run.knobs) return null;
  const {board, steps} = run.knobs;
  const gain = step => step.frames_per_second / board.frames_per_second - 1;
  const useful = steps.filter(
      step => gain(step) >= kWorthwhile && !step.changes_disparities && step.area.fits &&
          (!step.loses_pixels || board.loses_pixels));
  // Of a board that loses pixels, the best step that cures it comes first, whatever it gains or costs.
  const cure = board.loses_pixels &&
      steps.find(step => !step.loses_pixels && !step.changes_disparities && step.area.fits);
  const isCheap = step => {
    const price = priceOf(step, board);
    return price.banks <= 0 && price.slicesPercent <= kCheapSlices && price.blockRams <= 0 &&
        step.clock_mhz === board.clock_mhz;
  };
  const cheap = useful.filter(isCheap);
  return {
    first: cure || (cheap[0] ?? useful[0] ?? null),
    largest: useful[0] ?? null,
    gain,
    board,
    isCheap: cure ? isCheap(cure) : cheap.length > 0,
    cures: Boolean(cure),
  };
}

export const stepText = step => `${step.knob}: ${step.from} → ${step.to}`;
