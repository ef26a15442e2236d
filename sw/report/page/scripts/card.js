// What all pages are made of: the head line, the answers, and groups of cards. A card is a chart with its
// title, its note, its numbers as a table and as CSV.
import {button, download, fileName, h, note as noteLine} from './dom.js';
import {csvText, value, whole} from './format.js';
import {themeSwitch, whenThemeChanges} from './theme.js';
import {linkMarks} from './tooltip.js';

const kMostRows = 400;

// The sign stays in the line of its number.
const unbroken = text => text.replaceAll(' %', '\u00a0%');

export function addHead(page, {kind, name, headline, sub}) {
  document.title = `${name}: ${headline}`;
  page.append(
      h('header', {class: 'head'},
        h('div', {class: 'top'}, h('span', null, `stereotlm ${kind}`), h('b', null, name), themeSwitch()),
        h('h1', null, unbroken(headline)), sub));
}

// answers: [question, [answer, ..]]; answers that are null or false are left out.
export function addAnswers(page, answers) {
  const answerTo = ([question, texts]) => h(
      'div', null, h('dt', null, question), texts.filter(Boolean).map(text => h('dd', null, unbroken(text))));
  page.append(h('dl', {class: 'answers'}, answers.map(answerTo)));
}

// A heading, and below it the place of charts.
export function addGroup(page, title) {
  const group = h('div', {class: 'cards'});
  page.append(h('h2', {class: 'group'}, title), group);
  return group;
}

const isNumber = any =>
    typeof any === 'number' || (typeof any === 'string' && /^[+−]?[\d,]*\.?\d+( %)?$/.test(any));

// A table of HTML. Numbers are on the right.
export function htmlTable(names, rows, most = kMostRows) {
  const textOf = cell => cell instanceof Node ? cell : Number.isInteger(cell) ? whole(cell) : value(cell);
  const classOf = cell => isNumber(cell) && 'number';
  const rowOf = row => h('tr', null, row.map(cell => h('td', {class: classOf(cell)}, textOf(cell))));
  const head = names.map(
      (name, i) => name ? h('th', {scope: 'col', class: classOf(rows[0]?.[i])}, name) : h('td'));
  return h(
      'div', {class: 'scroll', tabindex: '0', role: 'group', 'aria-label': 'Table'},
      h('table', null, h('thead', null, h('tr', null, head)),
        h('tbody', null, rows.slice(0, most).map(rowOf))),
      noteLine(rows.length > most && `${whole(rows.length - most)} more rows: in the CSV`));
}

// Adds a chart to the page. `draw(host, width)` fills the empty element `host`; it is called again when the
// width or the theme changes. `numbers()` returns [names, rows]. `body`: elements above the plot that stay;
// `foot`: below it.
// Returns {element, redraw}.
export function addChart(page, {id, title, note, wide, body, foot, draw, numbers}) {
  const host = h('div', {class: 'plot'});
  const tableHost = h('div', {class: 'numbers', hidden: true});
  const toggle = button('Table', () => {
    tableHost.hidden = !tableHost.hidden;
    toggle.setAttribute('aria-expanded', String(!tableHost.hidden));
    tableHost.replaceChildren(...(tableHost.hidden ? [] : [htmlTable(...numbers())]));
  }, {'aria-expanded': 'false'});
  const save = button('CSV', () => download(`${fileName(id)}.csv`, 'text/csv', csvText(...numbers())));
  const element =
      h('section', {class: wide ? 'card wide' : 'card', id, 'aria-label': title},
        h('header', null, h('h2', null, title), numbers && h('div', {class: 'tools'}, toggle, save)),
        noteLine(note), body, draw && host, foot, tableHost);
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
    }).observe(host);
    whenThemeChanges(host, redraw);
  }
  return {element, redraw};
}

// A chart that --quick leaves out.
export const addLeftOut = (page, id, title) => addChart(page, {
  id,
  title,
  note: id === 'knobs' ?
      'Left out by --quick. `stereotlm report` without it tries single changes of the board.' :
      'The run has recorded nothing. `stereotlm run --out` does, without --no-record.'
});

// The names of colours, in a line: [[name, css colour], ..].
export const legend = entries =>
    h('ul', {class: 'legend'},
      entries.map(([name, colour]) => h('li', null, h('i', {style: `background:${colour}`}), name)));
