// The board of the live page: a preset, and the values of --set that make the board of it. With undo, and as
// the part of an address behind its #.

const kBoard = 'board';
const kCalibration = 'calibration';

// What was set at a path, or below it, goes when the path is set. So does, with the kind of a bank, what was
// set of it but its words.
const isWithin = (key, path) => `${key}.`.startsWith(`${path}.`) ||
    (/^ssram\..*\.kind$/.test(path) && key.startsWith(path.slice(0, -4)) && !key.endsWith('.words'));

// A board: {preset, sets: [[key, YAML], ..], calibration}. It is never changed. A key that is set to nothing
// has that of the preset again.
export function withSets(board, changes) {
  let sets = board.sets;
  for (const [path, text] of changes) sets = [...sets.filter(([key]) => !isWithin(key, path)), [path, text]];
  return {...board, sets: sets.filter(([, text]) => text !== '')};
}

export const splitSet = text => {
  const at = text.indexOf('=');
  return [text.slice(0, at), text.slice(at + 1)];
};

export function addressOf({preset, sets, calibration}) {
  const words = new URLSearchParams([[kBoard, preset], ...sets]);
  if (calibration) words.append(kCalibration, calibration);
  return `#${words}`;
}

// null for an address without board.
export function boardOf(address) {
  const words = new URLSearchParams(address.slice(1));
  const preset = words.get(kBoard);
  const sets = [...words].filter(([key]) => key !== kBoard && key !== kCalibration);
  return preset ? {preset, sets, calibration: words.get(kCalibration) ?? ''} : null;
}

// The command that has the figures of the page.
export function commandOf({preset, sets, calibration}, source, frames) {
  const quoted = text => /^[\w./=,:-]+$/.test(text) ? text : `'${text.replaceAll('\'', '\'\\\'\'')}'`;
  return [
    `stereotlm run ${preset}`, ...sets.map(([key, text]) => `--set ${quoted(`${key}=${text}`)}`),
    calibration && `--calibration ${quoted(calibration)}`, source === 'preloaded' && '--source preloaded',
    `--frames ${frames} --timing-only`
  ].filter(Boolean)
      .join(' ');
}

// The boards that were shown, one after the other. `changed(board)` is called when another one is shown.
export class History {
  constructor(first, changed) {
    this.boards = [first];
    this.at = 0;
    this.changed = changed;
  }
  get board() {
    return this.boards[this.at];
  }
  get canUndo() {
    return this.at > 0;
  }
  get canRedo() {
    return this.at + 1 < this.boards.length;
  }
  show(board) {
    if (addressOf(board) === addressOf(this.board)) return;
    const kMost = 1000;
    this.boards = [...this.boards.slice(0, this.at + 1), board].slice(-kMost);
    this.at = this.boards.length - 1;
    this.changed(board);
  }
  step(by) {
    if (!this.boards[this.at + by]) return;
    this.at += by;
    this.changed(this.board);
  }
}

// The value of a key of `allocation`, such as `[bank0, {rows: [bank1, bank2]}]`: YAML of names, lists and
// maps, and the same as a value of JavaScript.
const parsed = text => JSON.parse(text.replace(/[A-Za-z][\w-]*/g, '"$&"'));
const written = value => JSON.stringify(value).replaceAll('"', '').replace(/([:,])/g, '$1 ');

// The banks of the stripes of a buffer, with one in another bank. One that was there changes places with it.
const swapped = (banks, part, bank) =>
    banks.map((each, i) => i === part ? bank : each === bank ? banks[part] : each);

// The changes that move a buffer, such as allocation.left_image[0] or allocation.left_lut.rows[1]. A joint
// table is the buffer of left_lut, and moves as right_lut too.
export function movesOf(settings, buffer, bank) {
  const [, key, index, part] = /^([\w.]+?)(?:\[(\d+)\])?(?:\.rows\[(\d+)\])?$/.exec(buffer);
  const settingOf = name => settings.find(each => each.key === name).value;
  const value = parsed(settingOf(key));
  const list = Array.isArray(value) ? [...value] : [value];
  const place = Number(index ?? 0);
  list[place] = part === undefined ? bank : {rows: swapped(list[place].rows, Number(part), bank)};
  const text = written(Array.isArray(value) ? list : list[0]);
  const isJoint = key === 'allocation.left_lut' && settingOf('fpga.tables') === 'joint';
  return [[key, text], ...isJoint ? [['allocation.right_lut', text]] : []];
}

export const bankNames = settings => [...new Set(
    settings.map(({key}) => /^ssram\.banks\.([^.]+)\./.exec(key)?.[1]).filter(Boolean))];

// A name that no bank has.
export function newBankName(settings) {
  const names = bankNames(settings);
  let number = names.length;
  while (names.includes(`bank${number}`)) ++number;
  return `bank${number}`;
}

// The change that removes a bank: all others are given whole.
export function removalOf(settings, bank) {
  const banks = bankNames(settings).filter(name => name !== bank).map(name => {
    const path = `ssram.banks.${name}.`;
    const kind = settings.find(({key}) => key === `${path}kind`).value;
    // Of other kinds the turnaround has no effect, and may not be given.
    const values = settings.filter(
        ({key}) => key.startsWith(path) && !key.includes('.energy.') &&
            !(key.endsWith('.turnaround_cycles') && !/burst/.test(kind)));
    return `${name}: {${values.map(({key, value}) => `${key.slice(path.length)}: ${value}`).join(', ')}}`;
  });
  return ['ssram.banks', `{${banks.join(', ')}}`];
}
