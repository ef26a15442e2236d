// The waits over the picture, with sliders between the picture and its disparities, and for the overlay.
import {addChart} from './card.js';
import {choice, controls, h} from './dom.js';
import {count, most, whole} from './format.js';
import {viridis} from './theme.js';
import {hideTooltip, showTooltip} from './tooltip.js';

const kInvalid = 255;
const kMostHeight = 900;
const kOverlay = [255, 60, 0];

// {canvas, grey}. A picture without URL is grey. A picture of disparities gets colours, black where there is
// no answer, and has its values in `grey`.
async function pixelsOf({url, width, height, disparities}) {
  const image = new Image();
  if (url) {
    image.src = url;
    await image.decode();
  }
  const canvas = h('canvas', {
    width: width ?? image.naturalWidth,
    height: height ?? image.naturalHeight,
    'aria-hidden': 'true'
  });
  const context = canvas.getContext('2d', {willReadFrequently: true});
  context.fillStyle = '#808080';
  context.fillRect(0, 0, canvas.width, canvas.height);
  if (url) context.drawImage(image, 0, 0);
  if (!disparities) return {canvas};
  const data = context.getImageData(0, 0, canvas.width, canvas.height);
  const grey = new Uint8Array(canvas.width * canvas.height).map((_, i) => data.data[4 * i]);
  grey.forEach((value, i) => {
    data.data.set(value === kInvalid ? [0, 0, 0] : viridis(value / Math.max(1, disparities - 1)), 4 * i);
  });
  context.putImageData(data, 0, 0);
  return {canvas, grey};
}

// The amounts as a picture of their own, transparent where there is none.
function overlayOf({values, columns, rows}) {
  const canvas = h('canvas', {width: columns, height: rows, class: 'overlay', 'aria-hidden': 'true'});
  const context = canvas.getContext('2d');
  const data = context.createImageData(columns, rows);
  const highest = most(values);
  values.forEach((value, i) => {
    if (value > 0) data.data.set([...kOverlay, 40 + 215 * value / highest], 4 * i);
  });
  context.putImageData(data, 0, 0);
  return canvas;
}

// pictures: one or two of {url, disparities}, or of {width, height} without picture; only a picture of
// disparities has `disparities`. names: of the pictures. To the right of the slider the second picture covers
// the first. layers: maps as those of tilesOf(), summed over `frames` frames; the chosen one is drawn on top.
// `id`: of the chart, where a page has several.
export function addPicture(page, {id = 'picture', title, note, pictures, layers, frames, names}) {
  const overlays = layers.map(overlayOf);
  const stack = h('div', {
    class: 'picture hovers',
    tabindex: '0',
    role: 'group',
    'aria-label': `${title}. Arrow keys read the picture.`,
    style: '--split:50%;--overlay:40%'
  });
  const slider = (name, label) => {
    const input = event => stack.style.setProperty(`--${name}`, `${event.target.value}%`);
    const value = parseInt(stack.style.getPropertyValue(`--${name}`), 10);
    return h(
        'label', null, `${label} `,
        h('input', {type: 'range', min: 0, max: 100, value, id: `${id}-${name}`, input}));
  };
  let layer = null;
  const strongest = h('span', {class: 'note'});
  const choose = number => {
    layer = layers[number];
    overlays.forEach((overlay, i) => overlay.toggleAttribute('hidden', i !== Number(number)));
    strongest.textContent = layer &&
        `strongest colour: ${whole(most(layer.values))} cycles in a block of ${layer.width} × ${
                                layer.height} pixels, over ${count(frames, 'frame')}`;
  };
  addChart(page, {
    id,
    title,
    note,
    body: [
      controls(
          names[1] && slider('split', `${names[0]} | ${names[1]}`),
          layers.length > 0 &&
              [
                slider('overlay', 'overlay strength'),
                h('label', null, 'shown ',
                  choice(`${id}-layer`, layers.map((each, i) => [i, each.name]), 0, choose)),
                strongest
              ]),
      stack
    ],
    numbers: () => {
      const {values, columns, width, height} = layer ?? {values: []};
      const rows =
          [...values].map((value, i) => [Math.floor(i / columns) * height, i % columns * width, value]);
      return [['first_row', 'first_column', 'cycles'], rows.filter(row => row[2] !== 0)];
    }
  });
  choose(0);
  Promise.all(pictures.map(pixelsOf)).then(loaded => {
    const [{canvas: {width: columns, height: rows}}] = loaded;
    const grey = loaded.find(each => each.grey)?.grey;
    stack.style.maxWidth = `${kMostHeight * columns / rows}px`;
    stack.style.aspectRatio = `${columns} / ${rows}`;
    overlays.forEach((overlay, i) => {
      const {columns: across, rows: down, width, height} = layers[i];
      overlay.style.width = `${100 * across * width / columns}%`;
      overlay.style.height = `${100 * down * height / rows}%`;
    });
    stack.append(...loaded.map(({canvas}) => canvas), ...overlays);
    let at = [Math.round(columns / 2), Math.round(rows / 2)];
    // Shows the tooltip of a pixel beside it, or beside the pointer.
    const read = (x, y, pointer) => {
      at = [Math.max(0, Math.min(columns - 1, x)), Math.max(0, Math.min(rows - 1, y))];
      const value = grey?.[at[1] * columns + at[0]];
      const waits = layers.map(
          ({name,
            values,
            columns: across,
            width,
            height}) => [name, values[Math.floor(at[1] / height) * across + Math.floor(at[0] / width)]]);
      const box = stack.getBoundingClientRect();
      const scale = box.width / columns;
      const {clientX, clientY} =
          pointer ?? {clientX: box.left + at[0] * scale, clientY: box.top + at[1] * scale};
      showTooltip(
          [
            `column ${at[0]}, row ${at[1]}`,
            ...value === undefined ? [] : [value === kInvalid ? 'no disparity' : `disparity ${value}`],
            ...waits.filter(([, cycles]) => cycles).map(([name,
                                                          cycles]) => `${name}: ${whole(cycles)} cycles`)
          ],
          clientX, clientY);
    };
    stack.addEventListener('pointermove', event => {
      const box = stack.getBoundingClientRect();
      const scale = columns / box.width;
      read(
          Math.floor((event.clientX - box.left) * scale), Math.floor((event.clientY - box.top) * scale),
          event);
    });
    stack.addEventListener('pointerleave', hideTooltip);
    stack.addEventListener('keydown', event => {
      const [x, y] =
          {ArrowLeft: [-4, 0], ArrowRight: [4, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key] ?? [];
      if (x === undefined) return;
      event.preventDefault();
      read(at[0] + x, at[1] + y);
    });
  });
}
