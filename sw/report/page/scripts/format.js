// Numbers as text.

export const kPsOfMs = 1e9;

// Digits are grouped from 10,000 on.
// What is shown as zero has no sign.
// A format is kept: to make one takes longer than to use it.
const formats = [];
export const fixed = (number, digits) => (formats[digits] ??= new Intl.NumberFormat(
    'en-US', {minimumFractionDigits: digits, maximumFractionDigits: digits, useGrouping: 'min2',
              signDisplay: 'negative'})).format(number);
export const whole = number => fixed(Math.round(number), 0);
// A text with its counts as numbers of the page.
export const grouped = text => text.replace(/(?<![\w.])\d{5,}(?![\w.])/g, digits => whole(Number(digits)));
// What is more than nothing does not look like it: <0.1 %.
export function percent(share, digits = 1) {
  const least = 10 ** -digits;
  const isLess = share > 0 && 100 * share < least / 2;
  return `${isLess ? `<${fixed(least, digits)}` : fixed(100 * share, digits)} %`;
}
export const rate = number => fixed(number, number < 100 ? 2 : 1);
export const inMs = (ps, digits) => `${fixed(ps / kPsOfMs, digits)} ms`;
// The kinds of rates by their names in stats.json, the one to speak of first.
export const kRates = [['steady', 'steady'], ['system', 'from power-up'], ['core', 'core only']];
// With what a finite run leaves open, if that can be seen.
export const rateWith = (number, uncertainty = 0) =>
    rate(number) + (uncertainty < 0.005 ? '' : ` ± ${rate(uncertainty)}`);
// What stands behind a rate that was reached by losing pixels: so many, or `true`.
export const lossText = lost =>
    lost ? `, while captures lose ${lost === true ? 'pixels' : count(lost, 'pixel')}` : '';
const isShownAsZero = text => !/[1-9]/.test(text);
export const signed = (number, text) =>
    `${number < 0 && !isShownAsZero(text(Math.abs(number))) ? '−' : '+'}${text(Math.abs(number))}`;
// A gain, as a share of what there was.
export const gainText = gain => Math.abs(gain) < 0.0005 ? '≈ 0' : signed(gain, percent);
export const count = (number, noun) => `${whole(number)} ${noun}${number === 1 ? '' : 's'}`;
export const varyText = keys => `${count(keys, 'key')} ${keys === 1 ? 'varies' : 'vary'}`;

// For ticks: 1200 -> 1.2k.
export function brief(number) {
  if (typeof number !== 'number') return String(number);
  const size = Math.abs(number);
  for (const [unit, letter] of [[1e9, 'G'], [1e6, 'M'], [1e3, 'k']]) {
    if (size >= unit) return `${+ (number / unit).toPrecision(3)}${letter}`;
  }
  return String(+number.toPrecision(4));
}

// For tables that are looked at: what is beyond the ninth digit goes.
export const shortened = any => typeof any === 'number' ? +any.toPrecision(9) : any;

// A value of a table: every digit that it has.
export const value = any => any === null || any === undefined ? '' : String(any);

// The name of a bank, as bank_text() of platform/config/board_keys.h: bank0, but `bank matcher`.
export const bankText = name => /^bank\d+$/.test(name) ? name : `bank ${name}`;

export const capital = text => text.charAt(0).toUpperCase() + text.slice(1);

export const sum = numbers => numbers.reduce((total, number) => total + number, 0);
// Of lists that may be too long for the arguments of Math.min().
export const least = numbers => numbers.reduce((a, b) => Math.min(a, b), Infinity);
export const most = numbers => numbers.reduce((a, b) => Math.max(a, b), -Infinity);
// The different values of a column in their order: numbers by size, other values by their texts.
export const inOrder = (a, b) =>
    typeof a === 'number' && typeof b === 'number' ? a - b : value(a).localeCompare(value(b));
export const different = values => [...new Set(values)].sort(inOrder);

// Objects as a table of these columns: [names, rows].
export const tableOf = (names, objects) =>
    [names, objects.map(each => names.map(name => each[name] ?? null))];

function csvCell(any) {
  const text = value(any);
  return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
export const csvText =
    (names, rows) => [names, ...rows].map(row => `${row.map(csvCell).join(',')}\n`).join('');
