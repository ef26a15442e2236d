// What ports and banks do in the cycles of the frames: bars that add up to all cycles.
import {addChart, cut, drawing, legend} from './chart.js';
import {s} from './dom.js';
import {percent, whole} from './format.js';
import {mark} from './tooltip.js';

const kPortStates = [
  ['grants', 'granted', '--blue'], ['stall_cycles', 'waits', '--vermilion'],
  ['passed_cycles', 'no access needed', '--sky'], ['blocked_cycles', 'output full', '--yellow'],
  ['starved_cycles', 'no input', '--green'], ['idle_cycles', 'idle', '--pale']
];
const kBankStates = [
  ['busy_cycles', 'busy', '--blue'], ['turnaround_cycles', 'turnaround', '--grey'],
  ['idle_cycles', 'idle', '--pale']
];

function addStates(page, {id, title, note, items, states, cycles, more = () => []}) {
  const draw = (host, width) => {
    const left = Math.min(width * 0.3, 96);
    const {plot, width: inner} = drawing(host, width, items.length * 24 + 4, {left, right: 52}, title);
    items.forEach((item, line) => {
      const y = line * 24;
      plot.append(s('text', {x: -8, y: y + 15, 'text-anchor': 'end'}, cut(item.name, left - 8)));
      let x = 0;
      for (const [key, name, colour] of states) {
        const size = item[key] / cycles * inner;
        if (size > 0) {
          plot.append(mark(
              s('rect', {x, y: y + 3, width: Math.max(0.5, size), height: 17, style: `fill:var(${colour})`}),
              [
                `${item.name}: ${name} ${percent(item[key] / cycles, 2)}`, `${whole(item[key])} cycles`,
                ...more(item)
              ]));
        }
        x += size;
      }
      plot.append(s('text', {x: inner + 6, y: y + 15, class: 'value'}, percent(item[states[0][0]] / cycles)));
    });
  };
  addChart(page, {
    id,
    title,
    note,
    draw,
    body: legend(states.map(([, name, colour]) => [name, `var(${colour})`])),
    numbers: () => [
        ['name', ...states.map(([key]) => key)],
        items.map(item => [item.name, ...states.map(([key]) => item[key])])]
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
        'What each port does in all cycles of the frames; on the right the share granted. No access needed: ' +
        'it has the word already, or the place is outside the picture. Output full: the queue behind it takes ' +
        'no more. No input: nothing to work on has come. Idle: before its first and after its last work of a ' +
        'frame; the host: no request.'
  });
}

export function addBankUse(page, run) {
  const {stats, banks} = run;
  const busiest = [...stats.banks].sort((a, b) => b.utilization - a.utilization)[0];
  const unused = stats.banks.filter(bank => bank.busy_cycles === 0);
  addStates(page, {
    id: 'banks',
    items: stats.banks,
    states: kBankStates,
    cycles: stats.cycles,
    title: `${busiest.name} is busy in ${percent(busiest.utilization)} of the cycles` +
        (unused.length === 0     ? '' :
             unused.length === 1 ? `; ${unused[0].name} is never used` :
                                   `; ${unused.length} of ${stats.banks.length} banks are never used`),
    note: 'How busy each bank is in all cycles of the frames.',
    more: bank =>
        [`${whole(bank.reads)} reads, ${whole(bank.writes)} writes, ` +
             `in ${whole(bank.contended_cycles)} cycles a port waits`,
         banks.find(each => each.name === bank.name).buffers.map(buffer => buffer.name).join(', ') ||
             'holds nothing']
  });
}
