// What happens from top to bottom of the picture: use of the banks and waits. A range of rows can be brushed
// to look closer.
import {addBrush} from './brush.js';
import {addChart, canvasOf, cut, drawing, textWidth} from './chart.js';
import {commandLine} from './chart_config.js';
import {h, s} from './dom.js';
import {settingOf, waitingRows} from './findings.js';
import {count, percent, whole} from './format.js';
import {linesOf, rowsText} from './recording.js';
import {axisLeft, linear} from './scale.js';
import {css, heat} from './theme.js';
import {hideTooltip, mark, showTooltip} from './tooltip.js';

// The columns of the map: {name, what, values, fill, most, parts, waits}: amounts of each line, of which a cycle
// has at most `most`; whether they are waits.
function columnsOf(run, {accesses, stalls}) {
  const used = [...new Set(accesses.map(({bank}) => bank))].map(name => {
    const parts = accesses.filter(({bank}) => bank === name);
    const sumOf = read => parts.reduce((all, part) => all + read(part), 0);
    return {
      name,
      what: 'makes accesses',
      values: parts[0].values.map((_, line) => sumOf(part => part.values[line])),
      fill: sumOf(part => part.fill),
      most: run.banks.find(bank => bank.name === name).accesses_per_cycle,
      parts
    };
  });
  return [
    ...used, ...stalls.map(({port, bank, by, values, fill}) => ({
                             name: `${port} · ${by}`,
                             what: `waits on ${bank}`,
                             values,
                             fill,
                             most: 1,
                             parts: [],
                             waits: true
                           }))
  ];
}

// The command that traces the longest wait among these lines in the longest frame; null: no port waits.
function traceCommand(run, {stalls, height}, {from, to}) {
  if (!stalls.some(({values}) => values.slice(from, to).some(each => each !== 0))) return null;
  const cycles = run.stats.frame_cycles;
  const frame = cycles.indexOf(cycles.reduce((a, b) => Math.max(a, b)));
  const last = Math.min(to * height, settingOf(run, 'image.height')) - 1;
  const command = run.command.replace(/ --out DIR$/, '');
  return `${command} --trace vcd:waits.vcd --trace-window frame=${frame},rows=${from * height}..${last},longest-wait`;
}

export function addRows(page, run) {
  const recorded = linesOf(run);
  if (!recorded) {
    addChart(page, {
      id: 'rows',
      title: 'What happens in each row',
      note: 'Left out by --quick, because the run was not recorded.'
    });
    return;
  }
  const {cycles, lines, height: rowsOfLine, frames} = recorded;
  const imageHeight = settingOf(run, 'image.height');
  const columns = columnsOf(run, recorded);
  const shareOf = ({values, most}, line) => cycles[line] > 0 ? values[line] / cycles[line] / most : 0;
  const mostWaits = columns.filter(({waits}) => waits)
                        .flatMap(column => cycles.map((_, line) => shareOf(column, line)))
                        .reduce((a, b) => Math.max(a, b), 0);
  const tipOf = (column, line) =>
      [`${rowsText(recorded, line, line + 1, imageHeight)}: ${column.name} ${column.what} in ${
           percent(shareOf(column, line))} of the cycles`,
       `${whole(column.values[line])} in ${whole(cycles[line])} cycles`,
       ...column.parts.length > 1 ? column.parts.filter(part => part.values[line] > 0)
                                        .map(part => `${part.by}: ${whole(part.values[line])}`) :
                                    []];
  const state = {from: 0, to: lines};
  const draw = (host, width) => {
    const wordsOf = name => name.split(/(?<=_)| · | /);
    const upright = columns.some(  // names from bottom to top
        ({name}) => wordsOf(name).some(word => textWidth(word) + 6 > (width - 48) / columns.length));
    const top = upright ? Math.min(200, 16 + Math.max(...columns.map(({name}) => textWidth(name)))) : 60;
    const {plot, width: inner, height, svg} =
        drawing(host, width, 336 + top, {left: 44, right: 4, top, bottom: 8}, 'Rows of the picture');
    const y = linear([state.from * rowsOfLine, state.to * rowsOfLine], [0, height]);
    const step = inner / columns.length;
    const {canvas, context} = canvasOf(inner, height);
    canvas.style.cssText += `;position:absolute;left:44px;top:${top}px`;
    host.prepend(canvas);
    host.classList.add('layered');
    const shown = state.to - state.from;
    columns.forEach((column, i) => {
      for (let pixel = 0; pixel < height; ++pixel) {
        const first = state.from + Math.floor(pixel / height * shown);
        const last = Math.max(first + 1, state.from + Math.floor((pixel + 1) / height * shown));
        let share = 0;
        for (let line = first; line < last; ++line) share = Math.max(share, shareOf(column, line));
        context.fillStyle = css(heat(column.waits && mostWaits > 0 ? share / mostWaits : share));
        context.fillRect(i * step + 1, pixel, Math.max(1, step - 2), 1.5);
      }
    });
    plot.append(axisLeft(y, inner, height, 'row', {grid: false, ticks: 8}));
    columns.forEach((column, i) => {
      if (upright) {
        plot.append(
            s('text', {transform: `translate(${(i + 0.5) * step + 4} -6) rotate(-90)`},
              cut(column.name, top - 10)));
      } else {
        const words = textWidth(column.name) + 6 < step ? [column.name] : wordsOf(column.name);
        words.forEach(
            (word, line) => plot.append(
                s('text',
                  {x: i * step + step / 2, y: -6 - 13 * (words.length - 1 - line), 'text-anchor': 'middle'},
                  word)));
      }
      const total = column.values.reduce((all, value) => all + value, column.fill);
      const some = column.values.filter(each => each !== 0).length;
      plot.append(mark(
          s('rect',
            {x: i * step + 1, y: 4 - top, width: Math.max(1, step - 2), height: top - 6, class: 'reach'}),
          [
            `${column.name} ${column.what}`, `${whole(total)} in all`,
            `in ${some} of ${count(lines, rowsOfLine > 1 ? 'strip' : 'row')}`
          ]));
    });
    const {area} = addBrush(plot, {
      axis: 'y',
      width: inner,
      height,
      end: box => {
        if (!box) return;
        const [from, to] = [y.invert(box.y0) / rowsOfLine, y.invert(box.y1) / rowsOfLine];
        if (Math.ceil(to) - Math.floor(from) >= 4) zoom(Math.floor(from), Math.ceil(to));
      }
    });
    area.classList.add('hovers');
    area.addEventListener('pointermove', event => {
      const box = area.getBoundingClientRect();
      const line = Math.floor(y.invert((event.clientY - box.top) / box.height * height) / rowsOfLine);
      const column = columns[Math.floor((event.clientX - box.left) / box.width * columns.length)];
      if (column && line >= 0 && line < lines) showTooltip(tipOf(column, line), event.clientX, event.clientY);
    });
    area.addEventListener('pointerleave', hideTooltip);
    svg.style.position = 'relative';
  };
  const shownText = h('span', {class: 'note'});
  const trace = h('div');
  const sayShown = () => {
    shownText.textContent = rowsText(recorded, state.from, state.to, imageHeight);
    const command = traceCommand(run, recorded, state);
    trace.replaceChildren(...command ? [
      h('p', {class: 'note'}, 'The cycles around the longest wait in these rows of the longest frame, for a waveform viewer:'),
      commandLine(command)
    ] : []);
  };
  const zoom = (from, to) => {
    state.from = Math.max(0, Math.min(lines - 4, Math.round(from)));
    state.to = Math.min(lines, Math.max(state.from + 4, Math.round(to)));
    sayShown();
    chart.redraw();
  };
  const button = (label, name, from, to) =>
      h('button', {
        type: 'button',
        class: 'small',
        'aria-label': name,
        click: () => {
          const size = state.to - state.from;
          zoom(state.from + from * size, state.to + to * size);
        }
      },
        label);
  const tools =
      h('div', {class: 'controls'}, button('+', 'Zoom in', 0.25, -0.25), button('−', 'Zoom out', -0.5, 0.5),
        button('▲', 'Up', -0.25, -0.25), button('▼', 'Down', 0.25, 0.25),
        h('button', {type: 'button', class: 'small', click: () => zoom(0, lines)}, 'All rows'), shownText);
  const chart = addChart(page, {
    id: 'rows',
    draw,
    body: [tools, trace],
    title: `Ports wait ${waitingRows(run) ?? 'in no row of the picture'}`,
    note: `Banks: the share of the cycles of each row with an access. Ports: the share in which they wait. ` +
        `Sums over ${count(frames, 'frame')}. The colours of banks end at 100 %${
              mostWaits > 0 ? `, those of waits at the most of them in any row, ${percent(mostWaits)}` :
                              ''}. ` +
        'Drag over rows to zoom in.',
    numbers: () => {
      const named = [
        ...recorded.accesses.map(each => [`${each.bank} ${each.by} accesses`, each]),
        ...recorded.stalls.map(each => [`${each.port} on ${each.bank} for ${each.by}`, each])
      ];
      const last = line => Math.min((line + 1) * rowsOfLine, imageHeight) - 1;
      return [
        ['first_row', 'last_row', 'cycles', ...named.map(([name]) => name)],
        [
          ['', '', recorded.fill, ...named.map(([, {fill}]) => fill)],
          ...cycles.map(
              (all,
               line) => [line * rowsOfLine, last(line), all, ...named.map(([, {values}]) => values[line])])
        ]
      ];
    }
  });
  sayShown();
}
