// The waits over the picture: a slider between the picture and its disparities, one for the strength of the
// overlay.
import {addChart} from './card.js';
import {choice, controls, h} from './dom.js';
import {count, most, whole} from './format.js';
import {canvasOf} from './plot.js';
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
  const canvas = h('canvas', {width: width ?? image.naturalWidth, height: height ?? image.naturalHeight});
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
  const canvas = h('canvas', {width: columns, height: rows});
  const context = canvas.getContext('2d');
  const data = context.createImageData(columns, rows);
  const highest = most(values);
  values.forEach((value, i) => {
    if (value > 0) data.data.set([...kOverlay, 40 + 215 * value / highest], 4 * i);
  });
  context.putImageData(data, 0, 0);
  return canvas;
}

// pictures: one or two of {url, disparities}, the latter of a picture of disparities, or of {width, height}
// without picture; names: of the pictures.
// layers: maps of amounts as those of tilesOf(), sums over `frames` frames.
export function addPicture(page, {title, note, pictures, layers, frames, names}) {
  const state = {split: 0.5, overlay: 0.4, layer: 0};
  const overlays = layers.map(overlayOf);
  let loaded = null;
  let paint = () => {};
  const slider = (name, label) => {
    const input = event => {
      state[name] = event.target.value / 100;
      paint();
    };
    const value = 100 * state[name];
    return h(
        'label', null, `${label} `,
        h('input', {type: 'range', min: 0, max: 100, value, id: `picture-${name}`, input}));
  };
  const choose = choice('picture-layer', layers.map((layer, i) => [i, layer.name]), 0, layer => {
    state.layer = Number(layer);
    paint();
  });
  const strongest = h('span', {class: 'note'});
  const draw = (host, width) => {
    if (!loaded) return;
    const [first, second] = loaded.map(({canvas}) => canvas);
    const grey = loaded.find(each => each.grey)?.grey;
    const {width: columns, height: rows} = first;
    const scale = Math.min(width / columns, kMostHeight / rows);
    const [wide, high] = [columns * scale, rows * scale];
    const {canvas, context} = canvasOf(Math.round(wide), Math.round(high));
    canvas.classList.add('picture', 'hovers');
    canvas.setAttribute('tabindex', '0');
    canvas.setAttribute('aria-label', `${title}. Arrow keys read the picture.`);
    paint = () => {
      context.imageSmoothingEnabled = scale < 1;
      context.globalAlpha = 1;
      context.drawImage(first, 0, 0, wide, high);
      if (second && state.split < 1) {
        const left = state.split * columns;
        context.drawImage(second, left, 0, columns - left, rows, left * scale, 0, wide - left * scale, high);
        context.fillStyle = '#fff';
        context.fillRect(left * scale - 1, 0, 2, high);
      }
      const layer = layers[state.layer];
      if (!layer) return;
      context.imageSmoothingEnabled = false;
      context.globalAlpha = state.overlay;
      context.drawImage(
          overlays[state.layer], 0, 0, layer.columns * layer.width * scale,
          layer.rows * layer.height * scale);
      strongest.textContent = `strongest colour: ${whole(most(layer.values))} cycles in a block of ` +
          `${layer.width} × ${layer.height} pixels, over ${count(frames, 'frame')}`;
    };
    let at = [Math.round(columns / 2), Math.round(rows / 2)];
    // Shows the tooltip of a pixel beside it, or beside the pointer.
    const read = (x, y, pointer) => {
      at = [Math.max(0, Math.min(columns - 1, x)), Math.max(0, Math.min(rows - 1, y))];
      const value = grey?.[at[1] * columns + at[0]];
      const waits = layers.map(
          ({name,
            values,
            columns: tiles,
            width: wide,
            height: high}) => [name, values[Math.floor(at[1] / high) * tiles + Math.floor(at[0] / wide)]]);
      const box = canvas.getBoundingClientRect();
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
    canvas.addEventListener('pointermove', event => {
      const box = canvas.getBoundingClientRect();
      read(
          Math.floor((event.clientX - box.left) / scale), Math.floor((event.clientY - box.top) / scale),
          event);
    });
    canvas.addEventListener('pointerleave', hideTooltip);
    canvas.addEventListener('keydown', event => {
      const [x, y] =
          {ArrowLeft: [-4, 0], ArrowRight: [4, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key] ?? [];
      if (x === undefined) return;
      event.preventDefault();
      read(at[0] + x, at[1] + y);
    });
    host.append(canvas);
    paint();
  };
  const chart = addChart(page, {
    id: 'picture',
    title,
    note,
    draw,
    body: controls(
        names[1] && slider('split', `${names[0]} | ${names[1]}`),
        layers.length > 0 &&
            [slider('overlay', 'overlay strength'), h('label', null, 'shown ', choose), strongest]),
    numbers: () => {
      const {values, columns, width, height} = layers[state.layer] ?? {values: []};
      const rows =
          [...values].map((value, i) => [Math.floor(i / columns) * height, i % columns * width, value]);
      return [['first_row', 'first_column', 'cycles'], rows.filter(row => row[2] !== 0)];
    }
  });
  Promise.all(pictures.map(pixelsOf)).then(all => {
    loaded = all;
    chart.redraw();
  });
}
