// The keys of the board on the live page, in the groups of board files.
import {button, folded, h} from './dom.js';
import {capital} from './format.js';
import {ask} from './live_server.js';
import {newBankName, removalOf} from './live_state.js';

const kFirst = ['matcher', 'allocation', 'ssram', 'fpga'];
const schemaPath = path => path.replace(/^ssram\.banks\.[^.]+/, 'ssram.banks.NAME');
const groupOf = path => /^ssram\.banks\.[^.]+/.exec(path)?.[0] ?? path.split('.')[0];
const titleOf = group => group === 'name' ? 'Name' : group.replace('ssram.banks.', 'Bank ');

// The control for the values that the schema of a key allows.
function controlFor(path, schema, change) {
  const forms = schema?.anyOf ?? [schema ?? {}];
  const attributes = {id: `key-${path}`, change: event => change(event.target.value)};
  const [only] = forms;
  if (forms.length === 1 && only.enum) {
    return h('select', attributes, only.enum.map(word => h('option', {value: String(word)}, String(word))));
  }
  if (forms.length === 1 && (only.type === 'integer' || only.type === 'number')) {
    return h('input', {
      ...attributes,
      type: 'number',
      min: only.minimum,
      max: only.maximum,
      step: only.type === 'number' ? 'any' : only.multipleOf ?? 1
    });
  }
  return h('input', {...attributes, type: 'text', autocomplete: 'off', spellcheck: 'false'});
}

// set(changes): sets keys, and returns the board. fail(error): says what has gone wrong.
// Returns {show(settings), refuse(problems, board), element}.
export function makeKeys({keys, schema}, set, fail) {
  const about = new Map(keys.map(each => [each.key, each]));
  const rows = new Map();  // path -> {control, problem, row}
  const host = h('div', {class: 'keys'});
  const search = h('input', {type: 'search', id: 'search-keys-live', input: () => filter()});
  const element =
      h('section', {class: 'card', id: 'keys', 'aria-label': 'Keys of the board'}, h('h2', null, 'The keys'),
        h('label', {class: 'search'}, 'Search ', search), host);
  let settings = [];
  let paths = [];  // of the rows

  function filter() {
    const word = search.value.toLowerCase();
    for (const [path, {row}] of rows) {
      const {meaning = '', unit = ''} = about.get(schemaPath(path)) ?? {};
      row.hidden = !`${path} ${meaning} ${unit}`.toLowerCase().includes(word);
    }
    for (const group of host.querySelectorAll('details')) {
      const found = [...group.querySelectorAll('.key')].some(row => !row.hidden);
      group.hidden = !found;
      if (word && found) group.open = true;
    }
  }
  function rowOf(path) {
    const {meaning = '', unit = '', range = ''} = about.get(schemaPath(path)) ?? {};
    const control = controlFor(path, schema[schemaPath(path)], text => fill(set([[path, text]])));
    control.setAttribute('aria-describedby', `about-${path}`);
    const problem = h('p', {class: 'bad note', hidden: true});
    const name = path.startsWith('ssram.banks.') ? path.split('.').slice(3).join('.') :
                                                   path.split('.').slice(1).join('.');
    const row =
        h('div', {class: 'key', 'data-key': path},
          h('label',
            {for: `key-${path}`
            },
            name || path),
          h('span', {class: 'value'}, control, unit && ` ${unit}`),
          h('p', {class: 'note', id: `about-${path}`},
            `${capital(meaning.replace('the bank NAME', path.split('.')[2]))}. ${range}`),
          problem);
    rows.set(path, {control, problem, row});
    return row;
  }
  // Shows what a board sets, and for other keys the newest settings.
  function fill({sets}) {
    const values = new Map([['pci.load', 'none'], ...settings.map(({key, value}) => [key, value]), ...sets]);
    for (const [path, {control, problem}] of rows) {
      control.value = values.get(path) ?? '';
      problem.hidden = true;
    }
  }
  const isOfSdram = path => /required .* is sdram/.test(about.get(schemaPath(path))?.range);
  // Gives a bank what SDRAM needs.
  async function fillAsPreset(bank) {
    const {values} = await ask('check', {preset: 'sdram', sets: []});
    const its = Object.keys(values).filter(path => path.includes('.bank0.') && isOfSdram(path));
    fill(set(its.map(path => [path.replace('bank0', bank), String(values[path])])));
  }
  function build(all) {
    paths = all;
    const focused = document.activeElement.id;
    const open = new Set([...host.querySelectorAll('details[open]')].map(group => group.dataset.group));
    if (host.childElementCount === 0) open.add('matcher');
    rows.clear();
    const groups = new Map();
    for (const key of paths) {
      const group = groupOf(key);
      groups.set(group, [...groups.get(group) ?? [], key]);
    }
    if (groups.get('pci')?.every(key => !key.startsWith('pci.load'))) groups.get('pci').push('pci.load');
    const place = name => {
      const at = kFirst.indexOf(name.split('.')[0]);
      return at < 0 ? kFirst.length : at;
    };
    const names = [...groups.keys()].sort((a, b) => place(a) - place(b));
    const lastBank = names.filter(name => name.startsWith('ssram.')).at(-1);
    host.replaceChildren(...names.flatMap(name => {
      const details = folded(titleOf(name), groups.get(name).map(rowOf));
      details.dataset.group = name;
      details.open = open.has(name);
      const bank = /^ssram\.banks\.(.*)$/.exec(name)?.[1];
      if (bank) details.append(button(`Remove ${bank}`, () => set([removalOf(settings, bank)])));
      if (groups.get(name).some(path => isOfSdram(path) && !settings.some(({key}) => key === path))) {
        const fillIn = () => fillAsPreset(bank).catch(fail);
        rows.get(`${name}.kind`)?.row.append(button('Fill in as in the preset sdram', fillIn));
      }
      const add = () => set([[`ssram.banks.${newBankName(settings)}`, '{}']]);
      return name === lastBank ? [details, button('Add a bank', add, {id: 'add-bank'})] : [details];
    }));
    filter();
    document.getElementById(focused)?.focus({preventScroll: true});
  }
  return {
    element,
    show(now) {
      settings = now;
      const its = settings.map(({key}) => key);
      if (its.join() !== paths.join()) build(its);
      fill({sets: []});
    },
    // Shows the keys of a board that is not known yet or refused, with rows for those that it lacks, and each
    // problem beside its key.
    refuse(all, board) {
      const named = [...all, ...board.sets.map(([key]) => ({key}))].map(({key}) => key ?? '');
      const lacks = named.filter(key => about.has(schemaPath(key)) && !rows.has(key));
      if (all.length && lacks.length) {
        const places = new Map(keys.map(({key}, i) => [key, i]));
        const placeOf = path => places.get(schemaPath(path));
        build([...new Set([...paths, ...lacks])].sort((a, b) => placeOf(a) - placeOf(b)));
      }
      fill(board);
      for (const {key, place, rule, message} of all) {
        const row = rows.get(key) ?? rows.get(place?.replace('--set ', ''));
        if (!row) continue;
        const text = rows.has(key) ? rule : message;
        row.problem.textContent = row.problem.hidden ? text : `${row.problem.textContent}\n${text}`;
        row.problem.hidden = false;
        if (text.startsWith('missing')) row.control.value = '';
        row.row.closest('details').open = true;
      }
      const first = host.querySelector('.bad:not([hidden])');
      if (first && element.contains(document.activeElement)) first.scrollIntoView({block: 'nearest'});
    }
  };
}
