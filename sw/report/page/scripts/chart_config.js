// The board, every key, and the command that repeats the run.
import {addChart, htmlTable} from './chart.js';
import {copyButton, download, fileName, h} from './dom.js';
import {value} from './format.js';

// A text with buttons that copy and download it.
export function textBox(text, name) {
  const shown = h('pre', {tabindex: '0'}, text);
  return h(
      'div', {class: 'text'},
      h('div', {class: 'controls'}, copyButton('Copy', () => text, shown),
        h('button', {type: 'button', class: 'small', click: () => download(name, 'text/yaml', text)},
          'Download')),
      shown);
}

export function commandLine(command) {
  const shown = h('code', null, command);
  return h('div', {class: 'command'}, shown, copyButton('Copy', () => command, shown));
}

export function addConfiguration(page, run) {
  const host = h('div');
  const show = wanted => host.replaceChildren(htmlTable(
      ['key', 'value', 'unit', 'meaning'],
      run.settings
          .filter(
              ({key, value: its, meaning}) =>
                  `${key} ${its} ${meaning ?? ''}`.toLowerCase().includes(wanted.toLowerCase()))
          .map(({key, value: its, unit, meaning}) => [key, value(its), unit ?? '', meaning ?? ''])));
  show('');
  addChart(page, {
    id: 'configuration',
    wide: true,
    title: `The board ${run.stats.board}`,
    note: 'Every key with its value, and the board file as it was run.',
    body: [
      h('label', {class: 'search'}, 'Search ',
        h('input', {type: 'search', id: 'search-keys', input: event => show(event.target.value)})),
      host,
      h('details', null, h('summary', null, 'config.yaml'),
        textBox(run.config_yaml, `${fileName(run.stats.board)}.yaml`)),
      h('details', null, h('summary', null, 'stats.json'),
        textBox(JSON.stringify(run.stats, null, 2), 'stats.json'))
    ],
    numbers: () => [
        ['key', 'value', 'unit', 'meaning'],
        run.settings.map(({key, value: its, unit, meaning}) => [key, its, unit ?? '', meaning ?? ''])]
  });
}
