// What the core takes of its FPGA, part by part.
import {addChart, cut, drawing, shareBar} from './chart.js';
import {h, s} from './dom.js';
import {fixed, percent, whole} from './format.js';
import {mark} from './tooltip.js';

export function addArea(page, run) {
  const {items, total, device} = run.area;
  const all = items.reduce((sum, item) => sum + item.lut_equivalents, 0);
  const parts = [...items].sort((a, b) => b.lut_equivalents - a.lut_equivalents);
  const draw = (host, width) => {
    const left = Math.min(190, width * 0.42);
    const {plot, width: inner} =
        drawing(host, width, parts.length * 21 + 4, {left, right: 118}, 'Area by part');
    const most = parts[0].lut_equivalents;
    parts.forEach((part, line) => {
      const y = line * 21;
      plot.append(
          s('text', {x: -8, y: y + 14, 'text-anchor': 'end'},
            cut(part.count > 1 ? `${part.name} × ${whole(part.count)}` : part.name, left - 8)),
          mark(
              s('rect', {
                x: 0,
                y: y + 4,
                width: Math.max(1, part.lut_equivalents / most * inner),
                height: 13,
                style: 'fill:var(--blue)'
              }),
              [
                `${part.name}: ${percent(part.lut_equivalents / all)} of the logic`,
                `${whole(part.luts)} LUTs, ${whole(part.flip_flops)} flip-flops`,
                `${whole(part.block_rams)} block RAMs, ${whole(part.multipliers)} multipliers`
              ]),
          s('text', {x: inner + 64, y: y + 14, 'text-anchor': 'end', class: 'value'},
            percent(part.lut_equivalents / all)),
          part.block_rams > 0 &&
                  s('text', {x: inner + 116, y: y + 14, 'text-anchor': 'end', class: 'value'},
                    `${part.block_rams} RAM`) ||
              '');
    });
  };
  const use = (name, number, of) =>
      h('span', null, `${name} ${whole(number)} of ${whole(of)} `, shareBar(number / of, name),
        ` ${fixed(100 * number / of, 1)} %`);
  addChart(page, {
    id: 'area',
    wide: true,
    draw,
    title: `${fixed(total.slices_percent, 1)} % of the ${device.name}: ${whole(total.slices)} slices${
        total.fits ? '' : ', which does not fit'}`,
    note:
        'An estimate: nothing is placed or routed. Bars: share of the logic, by the larger of a part\'s LUTs and ' +
        'flip-flops.',
    body:
        h('div', {class: 'uses'}, use('slices', total.slices, device.slices),
          use('block RAMs', total.block_rams, device.block_rams),
          use('multipliers', total.multipliers, device.multipliers)),
    numbers: () => [
        ['part', 'count', 'luts', 'flip_flops', 'block_rams', 'multipliers', 'lut_equivalents'],
        items.map(
            item =>
                [item.name, item.count, item.luts, item.flip_flops, item.block_rams, item.multipliers,
                 item.lut_equivalents])]
  });
}
