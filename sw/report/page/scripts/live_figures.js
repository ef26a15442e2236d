// The figures of the live page: rates, area, pins, energy and waits of the board, and how they differ from A.
import {againstBound, lostPixels, rateOf, waitsOf, waitText} from './findings.js';
import {count, fixed, lossText, rate, rateWith, signed, whole} from './format.js';
import {withFoldedLanes} from './lanes.js';
import {h} from './dom.js';

// [name, source of the run, number of a run, text of a number, what to say beside it]
const boundNote = run => againstBound(rateOf(run), rateOf(run).limit, rateOf(run).by);
const kFigures = [
  ['core frames/s', 'preloaded', run => run.stats.frames_per_second.core, rate, boundNote],
  [
    'computer frames/s', 'camera', run => rateOf(run).now,
    (number, run) => rateWith(number, run?.stats.frames_per_second.steady_uncertainty),
    run => [rateOf(run).kind + lossText(lostPixels(run)), exactText(run), boundNote(run)]
               .filter(Boolean)
               .join('; ')
  ],
  [
    'slices %', 'preloaded', run => run.area.slices_percent, number => fixed(number, 2),
    run => `${whole(run.area.slices)} slices, ${count(run.area.block_rams, 'block RAM')}, ${
        count(run.area.multipliers, 'multiplier')} of the ${run.area.device.name}${
        run.area.fits ? '' : ': does not fit'}`
  ],
  [
    'pins', 'preloaded', run => run.pins, whole,
    run => `${run.banks_used} of ${count(run.banks.length, 'bank')} used`
  ],
  [
    'mJ a frame', 'preloaded', run => run.stats.energy.memory_mj_per_frame, number => fixed(number, 2),
    run => `the memories alone, ${fixed(run.stats.energy.megabytes_per_frame, 1)} MB a frame`
  ],
  [
    'waits %', 'preloaded', run => 100 * (waitsOf(run)[0]?.share ?? 0), number => fixed(number, 2),
    run => waitsOf(run).length ? waitText(waitsOf(run)[0]) : 'no port waits'
  ],
];
const exactText = ({stats: {frames_per_second: rates}}) => rates.exact !== undefined &&
    `exactly ${rates.exact_delivered_frames} in ${rates.exact_camera_frames} camera frames`;

// The cells of the figures. runs: the newest answers by source; pinned: those of A, or null.
export const figureCells = (runs, pinned) => kFigures.map(([title, source, numberOf, textOf, noteOf]) => {
  const [now, then] = [runs[source], pinned?.[source]].map(answer => answer && withFoldedLanes(answer.run));
  const number = now && numberOf(now);
  const difference = now && then && number - numberOf(then);
  return h(
      'div', {'data-source': source, 'data-figure': title}, h('dt', null, title, h('span', {class: 'state'})),
      h('dd', {'data-value': number ?? ''}, now ? textOf(number, now) : '…'),
      then && now &&
          h('dd', {class: 'difference'},
            `A: ${textOf(numberOf(then), then)}, ${
                Math.abs(difference) < 0.005 ? 'the same' : signed(difference, each => fixed(each, 2))}`),
      h('dd', {class: 'note'}, now ? noteOf(now) : ''));
});

// All numbers of stats.json, of A and now.
export function differenceTable(a, now) {
  const flat = (value, path = '') => Object.entries(value).flatMap(
      ([key, its]) => its !== null && typeof its === 'object' ? flat(its, `${path}${its.name ?? key}.`) :
          typeof its === 'number' ? [[path + key, its]] :
                                    []);
  const before = new Map(flat(a.stats));
  const rows = flat(now.stats)
                   .filter(([path, its]) => before.has(path) && before.get(path) !== its)
                   .map(([path, its]) => [path, before.get(path), its, its - before.get(path)]);
  return [['figure', 'A', 'now', 'difference'], rows];
}
