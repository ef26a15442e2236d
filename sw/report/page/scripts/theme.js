// Light and dark, and colours. All palettes can be told apart by the colour blind: Okabe and Ito's for names,
// viridis for disparities, one hue that grows darker (in the dark: lighter) for amounts.
import {choice, h} from './dom.js';

const kDark = matchMedia('(prefers-color-scheme: dark)');
let themeChosen = 'auto';
let themePrints = false;

export const isDark = () => !themePrints && (themeChosen === 'auto' ? kDark.matches : themeChosen === 'dark');
// Calls the listener while the element is in the page.
export function whenThemeChanges(element, listener) {
  element.classList.add('themed');
  element.addEventListener('themechange', listener);
}

function applyTheme() {
  document.documentElement.dataset.theme = isDark() ? 'dark' : 'light';
  for (const element of document.querySelectorAll('.themed')) element.dispatchEvent(new Event('themechange'));
}

export function themeSwitch() {
  const themes = ['auto', 'light', 'dark'].map(name => [name, name]);
  return h('label', {class: 'theme'}, 'Theme ', choice('theme', themes, themeChosen, theme => {
             themeChosen = theme;
             applyTheme();
           }));
}

kDark.addEventListener('change', applyTheme);
for (const [event, prints] of [['beforeprint', true], ['afterprint', false]]) {
  addEventListener(event, () => {
    themePrints = prints;
    applyTheme();
  });
}
document.documentElement.dataset.theme = isDark() ? 'dark' : 'light';

// The value of a variable of the style sheet, for a canvas.
export const styleColour = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

const kNamed = {
  left_lut: '--blue',
  right_lut: '--sky',
  left_pixel: '--vermilion',
  right_pixel: '--orange',
  result: '--green',
  host: '--purple',
  turnaround: '--grey',
  row: '--yellow',
  refresh: '--pale',
};
const kOthers = ['--blue', '--vermilion', '--green', '--orange', '--sky', '--purple', '--yellow', '--grey'];
// The variable of the colour of a port or a cause; `host capture` has that of the host,
// and a lane that of its port group.
export const namedColour = name => kNamed[name] ?? kNamed[name.split(/[ .]/)[0]] ?? '--grey';
export const nthColour = number => kOthers[number % kOthers.length];

const kViridis = [
  [68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137], [53, 183, 121],
  [110, 206, 88], [181, 222, 43], [253, 231, 37]
];
const kHeatLight = [[250, 247, 243], [253, 212, 158], [253, 141, 60], [217, 72, 1], [127, 39, 4]];
const kHeatDark = [[32, 35, 40], [92, 40, 40], [176, 64, 28], [240, 140, 40], [255, 236, 170]];

function between(stops, share) {
  const place = Math.max(0, Math.min(1, share)) * (stops.length - 1);
  const low = Math.min(stops.length - 2, Math.floor(place));
  return stops[low].map((from, i) => Math.round(from + (stops[low + 1][i] - from) * (place - low)));
}
// [red, green, blue] for a share of 0 to 1.
export const viridis = share => between(kViridis, share);
export const heat = share => between(isDark() ? kHeatDark : kHeatLight, share);
export const css = ([red, green, blue]) => `rgb(${red} ${green} ${blue})`;
// Black or white, whichever can be read on the colour.
export const inkOn = ([red, green, blue]) => 0.3 * red + 0.59 * green + 0.11 * blue > 140 ? '#111' : '#fff';
