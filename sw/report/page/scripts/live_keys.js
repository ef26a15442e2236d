// The keys of the board on the live page, in the groups of board files.
import {button, folded, h} from './dom.js';
import {capital} from './format.js';
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

// set(changes): sets keys. Returns {show(settings), refuse(problems), element}.
export function makeKeys({keys, schema}, set) {
  const about = new Map(keys.map(each => [each.key, each]));
  const rows = new Map();  // path -> {control, problem, row}
  const host = h('div', {class: 'keys'});
  const problems = h('ul', {class: 'problems', role: 'alert'});
  const search = h('input', {type: 'search', id: 'search-keys-live', input: () => filter()});
  const element =
      h('section', {class: 'card', id: 'keys', 'aria-label': 'Keys of the board'}, h('h2', null, 'The keys'),
        problems, h('label', {class: 'search'}, 'Search ', search), host);
  let settings = [];

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
    const control = controlFor(path, schema[schemaPath(path)], text => set([[path, text]]));
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
          h('p', {class: 'note', id: `about-${path}`}, `${capital(meaning)}. ${range}`), problem);
    rows.set(path, {control, problem, row});
    return row;
  }
  function build() {
    const open = new Set([...host.querySelectorAll('details[open]')].map(group => group.dataset.group));
    if (host.childElementCount === 0) open.add('matcher');
    rows.clear();
    const groups = new Map();
    for (const {key} of settings) {
      const group = groupOf(key);
      groups.set(group, [...groups.get(group) ?? [], key]);
    }
    if (!groups.get('pci').some(key => key.startsWith('pci.load'))) groups.get('pci').push('pci.load');
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
      const add = () => set([[`ssram.banks.${newBankName(settings)}`, '{}']]);
      return name === lastBank ? [details, button('Add a bank', add, {id: 'add-bank'})] : [details];
    }));
    filter();
  }
  return {
    element,
    show(now) {
      const isSame = now.length === settings.length && now.every(({key}, i) => key === settings[i].key);
      settings = now;
      if (!isSame) build();
      const values = new Map(settings.map(({key, value}) => [key, String(value)]));
      for (const [path, {control, problem}] of rows) {
        control.value = values.get(path) ?? 'none';
        problem.hidden = true;
      }
      problems.replaceChildren();
    },
    // Shows each problem beside its key, and all of them above.
    refuse(all) {
      for (const {problem} of rows.values()) problem.hidden = true;
      problems.replaceChildren(...all.map(
          ({place, message}) => h('li', null, message.includes(' ') ? message : `${place}: ${message}`)));
      for (const {key, place, rule, message} of all) {
        const row = rows.get(key) ?? rows.get(place?.replace('--set ', ''));
        if (!row) continue;
        const text = rows.has(key) ? rule : message;
        row.problem.textContent = row.problem.hidden ? text : `${row.problem.textContent}\n${text}`;
        row.problem.hidden = false;
        row.row.closest('details').open = true;
      }
    }
  };
}
