// The waits over the picture: a slider between the picture and its disparities, one for the strength of the
// overlay.
import {addChart, canvasOf} from './chart.js';
import {h} from './dom.js';
import {count, whole} from './format.js';
import {viridis} from './theme.js';
import {hideTooltip, showTooltip} from './tooltip.js';

const kInvalid = 255;
const kMostHeight = 900;
const kOverlay = [255, 60, 0];

// A picture without URL is grey.
async function pixelsOf({url, width, height}) {
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
  return {canvas, context, data: context.getImageData(0, 0, canvas.width, canvas.height)};
}

// The disparities in colours; no answer is black. Returns the grey values.
function colourDisparities({context, data}, disparities) {
  const grey = new Uint8Array(data.data.length / 4);
  for (let i = 0; i < grey.length; ++i) {
    grey[i] = data.data[4 * i];
    const colour = grey[i] === kInvalid ? [0, 0, 0] : viridis(grey[i] / Math.max(1, disparities - 1));
    data.data.set(colour, 4 * i);
  }
  context.putImageData(data, 0, 0);
  return grey;
}

// The amounts as a picture of their own, transparent where there is none.
function overlayOf({values, columns, rows}) {
  const canvas = h('canvas', {width: columns, height: rows});
  const context = canvas.getContext('2d');
  const data = context.createImageData(columns, rows);
  let most = 0;
  for (const value of values) most = Math.max(most, value);
  values.forEach((value, i) => {
    if (value <= 0) return;
    data.data.set(kOverlay, 4 * i);
    data.data[4 * i + 3] = 40 + 215 * value / most;
  });
  context.putImageData(data, 0, 0);
  return canvas;
}

// pictures: one or two of {url, disparities}, the latter of a picture of disparities, or of {width, height}
// without picture; names: of the pictures.
// layers: maps of amounts as those of tilesOf(), sums over `frames` frames.
export function addPicture(page, {id = 'picture', title, note, pictures, layers, frames, names}) {
  const state = {split: 0.5, overlay: 0.4, layer: 0};
  let loaded = null;
  let drawn = null;
  const slider = (name, label, key) => h('label', null, `${label} `, h('input', {
                                           type: 'range',
                                           min: 0,
                                           max: 100,
                                           value: 100 * state[key],
                                           id: `${id}-${name}`,
                                           input: event => {
                                             state[key] = event.target.value / 100;
                                             drawn?.();
                                           }
                                         }));
  const choose =
      h('select', {
        id: `${id}-layer`,
        change: event => {
          state.layer = Number(event.target.value);
          drawn?.();
        }
      },
        layers.map((layer, i) => h('option', {value: i}, layer.name)));
  const most = h('span', {class: 'note'});
  const draw = (host, width) => {
    if (!loaded) return;
    const {width: columns, height: rows} = loaded.first.canvas;
    const scale = Math.min(width / columns, kMostHeight / rows);
    const {canvas, context} = canvasOf(Math.round(columns * scale), Math.round(rows * scale));
    const [w, hgt] = [columns * scale, rows * scale];
    canvas.classList.add('picture', 'hovers');
    canvas.setAttribute('tabindex', '0');
    canvas.setAttribute('aria-label', `${title}. Arrow keys read the picture.`);
    let at = [Math.round(columns / 2), Math.round(rows / 2)];
    const overlays = layers.map(overlayOf);
    drawn = () => {
      context.imageSmoothingEnabled = scale < 1;
      context.globalAlpha = 1;
      context.drawImage(loaded.first.canvas, 0, 0, w, hgt);
      if (loaded.second && state.split < 1) {
        context.save();
        context.beginPath();
        context.rect(w * state.split, 0, w, hgt);
        context.clip();
        context.drawImage(loaded.second.canvas, 0, 0, w, hgt);
        context.restore();
        context.fillStyle = '#fff';
        context.fillRect(w * state.split - 1, 0, 2, hgt);
      }
      context.imageSmoothingEnabled = false;
      context.globalAlpha = state.overlay;
      const layer = layers[state.layer];
      if (layer) {
        context.drawImage(
            overlays[state.layer], 0, 0, layer.columns * layer.width * scale,
            layer.rows * layer.height * scale);
        most.textContent = `strongest colour: ${
                               whole(layer.values.reduce((a, b) => Math.max(a, b)))} cycles in a block of ` +
            `${layer.width} × ${layer.height} pixels, over ${count(frames, 'frame')}`;
      }
    };
    const tip = (clientX, clientY) => {
      const [x, y] = at;
      const lines = [`column ${x}, row ${y}`];
      const grey = loaded.grey?.[y * columns + x];
      if (grey !== undefined) lines.push(grey === kInvalid ? 'no disparity' : `disparity ${grey}`);
      for (const layer of layers) {
        const value =
            layer.values[Math.floor(y / layer.height) * layer.columns + Math.floor(x / layer.width)];
        if (value) lines.push(`${layer.name}: ${whole(value)} cycles`);
      }
      showTooltip(lines, clientX, clientY);
    };
    const place = (x, y) => {
      at = [Math.max(0, Math.min(columns - 1, x)), Math.max(0, Math.min(rows - 1, y))];
    };
    canvas.addEventListener('pointermove', event => {
      const box = canvas.getBoundingClientRect();
      place(Math.floor((event.clientX - box.left) / scale), Math.floor((event.clientY - box.top) / scale));
      tip(event.clientX, event.clientY);
    });
    canvas.addEventListener('pointerleave', hideTooltip);
    canvas.addEventListener('keydown', event => {
      const [x, y] =
          {ArrowLeft: [-4, 0], ArrowRight: [4, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key] ?? [];
      if (x === undefined) return;
      event.preventDefault();
      place(at[0] + x, at[1] + y);
      const box = canvas.getBoundingClientRect();
      tip(box.left + at[0] * scale, box.top + at[1] * scale);
    });
    host.append(canvas);
    drawn();
  };
  const chart = addChart(page, {
    id,
    title,
    note,
    draw,
    body:
        h('div', {class: 'controls'}, names[1] && slider('split', `${names[0]} | ${names[1]}`, 'split'),
          layers.length > 0 && slider('overlay', 'overlay strength', 'overlay'),
          layers.length > 0 && h('label', null, 'shown ', choose), layers.length > 0 && most),
    numbers: () => layers.length === 0 ? [['cycles'], []] :
                                         [
                                           ['first_row', 'first_column', 'cycles'],
                                           [...layers[state.layer].values]
                                               .map(
                                                   (value, i) =>
                                                       [Math.floor(i / layers[state.layer].columns) *
                                                            layers[state.layer].height,
                                                        i % layers[state.layer].columns *
                                                            layers[state.layer].width,
                                                        value])
                                               .filter(row => row[2] !== 0)
                                         ]
  });
  (async () => {
    const first = await pixelsOf(pictures[0]);
    const second = pictures[1] ? await pixelsOf(pictures[1]) : null;
    const all = [first, second];
    const greys = pictures.map(
        (picture, i) => picture.disparities ? colourDisparities(all[i], picture.disparities) : null);
    loaded = {first, second, grey: greys.find(Boolean)};
    chart.redraw();
  })();
  return chart;
}
