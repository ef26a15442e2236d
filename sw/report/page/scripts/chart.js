// The frame of a chart: title, note, the plot, its numbers as a table and as CSV.
import {download, fileName, h, s} from './dom.js';
import {csvText, value, whole} from './format.js';
import {whenThemeChanges} from './theme.js';
import {linkMarks} from './tooltip.js';

const kMostRows = 400;

const isNumber = any =>
    typeof any === 'number' || (typeof any === 'string' && /^[+−]?[\d,]*\.?\d+( %)?$/.test(any));

// A table of HTML. Numbers are on the right.
export function htmlTable(names, rows, most = kMostRows) {
  const cells = row => row.map(
      cell =>
          h('td', {class: isNumber(cell) && 'number'},
            cell instanceof Node       ? cell :
                Number.isInteger(cell) ? whole(cell) :
                                         value(cell)));
  const head =
      names.map((name, i) => h('th', {scope: 'col', class: isNumber(rows[0]?.[i]) && 'number'}, name));
  return h(
      'div', {class: 'scroll', tabindex: '0', role: 'region', 'aria-label': 'Table'},
      h('table', null, h('thead', null, h('tr', null, head)),
        h('tbody', null, rows.slice(0, most).map(row => h('tr', null, cells(row))))),
      rows.length > most && h('p', {class: 'note'}, `${whole(rows.length - most)} more rows: in the CSV`));
}

// Adds a chart to the page. `draw(host, width)` fills the empty element `host`; it is called again where the
// width or the theme changes. `numbers()` returns [names, rows]. `body`: elements above the plot that stay;
// `foot`: below it.
// Returns {element, redraw}.
export function addChart(page, {id, title, note, wide, body, foot, draw, numbers}) {
  const host = h('div', {class: 'plot'});
  const tableHost = h('div', {class: 'numbers', hidden: true});
  const toggle =
      h('button', {
        type: 'button',
        class: 'small',
        'aria-expanded': 'false',
        click: () => {
          tableHost.hidden = !tableHost.hidden;
          toggle.setAttribute('aria-expanded', String(!tableHost.hidden));
          tableHost.replaceChildren(...(tableHost.hidden ? [] : [htmlTable(...numbers())]));
        }
      },
        'Table');
  const save =
      h('button', {
        type: 'button',
        class: 'small',
        click: () => download(`${fileName(id)}.csv`, 'text/csv', csvText(...numbers()))
      },
        'CSV');
  const element =
      h('section', {class: wide ? 'card wide' : 'card', id, 'aria-label': title},
        h('header', null, h('h2', null, title), numbers && h('div', {class: 'tools'}, toggle, save)),
        note && h('p', {class: 'note'}, note), body, draw && host, foot, tableHost);
  page.append(element);
  let width = 0;
  const redraw = () => {
    if (width === 0) return;
    const focused = [...host.querySelectorAll('.mark')].indexOf(document.activeElement);
    host.replaceChildren();
    draw(host, width);
    linkMarks(host);
    if (focused >= 0) host.querySelectorAll('.mark')[focused]?.focus();
  };
  if (draw) {
    new ResizeObserver(([entry]) => {
      const now = Math.floor(entry.contentRect.width);
      if (now === width || now === 0) return;
      width = now;
      redraw();
    }).observe(element.querySelector('.plot'));
    whenThemeChanges(redraw);
  }
  return {element, redraw};
}

// An empty drawing with margins: {svg, plot, width, height}; `plot` is the group inside the margins.
export function drawing(host, width, height, {left = 0, right = 0, top = 0, bottom = 0}, label = '') {
  const plot = s('g', {transform: `translate(${left} ${top})`});
  const svg =
      s('svg', {viewBox: `0 0 ${width} ${height}`, width, height, role: 'group', 'aria-label': label}, plot);
  host.append(svg);
  return {svg, plot, width: width - left - right, height: height - top - bottom};
}

// A canvas as sharp as the screen, and its context in pixels of the style sheet.
export function canvasOf(width, height) {
  const density = window.devicePixelRatio || 1;
  const canvas = h('canvas', {
    width: Math.round(width * density),
    height: Math.round(height * density),
    style: `width:${width}px;height:${height}px`
  });
  const context = canvas.getContext('2d');
  context.scale(density, density);
  return {canvas, context};
}

// A share of 0 to 1 as a little bar.
export const shareBar = (share, label) =>
    h('span', {class: 'bar', role: 'img', 'aria-label': label},
      h('i', {style: `width:${Math.max(0, Math.min(100, 100 * share))}%`}));

// The names of colours, in a line: [[name, css colour], ..].
export const legend = entries =>
    h('ul', {class: 'legend'},
      entries.map(([name, colour]) => h('li', null, h('i', {style: `background:${colour}`}), name)));

// The width of a text in the small type of charts, in pixels.
export const textWidth = text => text.length * 6.3;
export const cut = (text, width) => {
  const letters = Math.floor(width / 6.3);
  return text.length <= letters ? text : `${text.slice(0, Math.max(1, letters - 1))}…`;
};
