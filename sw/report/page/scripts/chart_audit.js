// The identities between the figures: computed here once more, with both sides.
import {addChart, htmlTable} from './chart.js';
import {h} from './dom.js';
import {sum} from './format.js';
import {linesOf} from './recording.js';

const kPortStateKeys =
    ['grants', 'stall_cycles', 'passed_cycles', 'idle_cycles', 'blocked_cycles', 'starved_cycles'];
const kBankStateKeys = ['busy_cycles', 'turnaround_cycles', 'idle_cycles'];

// [what, left side, right side]
export function identitiesOf(run) {
  const {stats} = run;
  const lines = linesOf(run);
  const all = [];
  for (const port of stats.ports) {
    all.push(
        [`${port.name}: its six states = cycles`, sum(kPortStateKeys.map(key => port[key])), stats.cycles]);
    all.push([
      `${port.name}: waits by cause = waits counted`,
      sum(stats.blame.filter(row => row.port === port.name).map(row => row.cycles)), port.stall_cycles
    ]);
  }
  for (const bank of stats.banks)
    all.push([
      `${bank.name}: busy, turnaround, idle = cycles`, sum(kBankStateKeys.map(key => bank[key])), stats.cycles
    ]);
  all.push([
    'accesses of the banks = grants of the ports', sum(stats.banks.map(bank => bank.reads + bank.writes)),
    sum(stats.ports.map(port => port.grants))
  ]);
  for (const camera of stats.cameras ?? []) {
    all.push([
      `${camera.name} camera: captured and dropped = frames`, camera.captured_frames + camera.dropped_frames,
      camera.frames
    ]);
    all.push([
      `${camera.name} camera: drops by reason = dropped`,
      camera.dropped_not_armed + camera.dropped_busy + camera.dropped_by_partner, camera.dropped_frames
    ]);
  }
  if (lines) {
    all.push(['cycles of the rows = cycles', lines.fill + sum(lines.cycles), stats.cycles]);
    const totalOf = some => sum(some.map(each => each.total));
    const portOf = name => name.startsWith('host ') ? 'host' : name;
    for (const {name, stall_cycles: stalls} of stats.ports)
      all.push([
        `${name}: waits of the rows = waits counted`,
        totalOf(lines.stalls.filter(({port}) => portOf(port) === name)), stalls
      ]);
    for (const {name, reads, writes} of stats.banks)
      all.push([
        `${name}: accesses of the rows = reads and writes`,
        totalOf(lines.accesses.filter(({bank}) => bank === name)), reads + writes
      ]);
  }
  return all;
}

export function addAudit(page, run) {
  const identities = identitiesOf(run);
  const broken =
      identities.filter(([, left, right]) => left !== right).length + (run.stats.failed?.length ?? 0);
  addChart(page, {
    id: 'audit',
    wide: true,
    title: broken === 0 ? `All ${identities.length} identities hold` :
                          `${broken} of ${identities.length} identities do not hold`,
    note: `Computed again by this page from the figures that it shows${
        run.knobs ? '; the run was repeated for this report, and gave its stats.json byte for byte' : ''}.`,
    body: [
      run.stats.failed && h('ul', {class: 'bad'}, run.stats.failed.map(text => h('li', null, text))),
      h('details', {open: broken > 0}, h('summary', null, 'Both sides of each'),
        htmlTable(
            ['identity', 'left', 'right', ''],
            identities.map(([what, left, right]) => [what, left, right, left === right ? '✓' : '✗'])))
    ],
    numbers: () => [['identity', 'left', 'right'], identities]
  });
}
