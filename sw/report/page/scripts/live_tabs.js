// Two tabs of the live page: the board on pictures, and a sweep of one or two of its keys.
import {addGroup} from './card.js';
import {button, controls, h, note} from './dom.js';
import {fixed, percent} from './format.js';
import {ask, askLong, sendPicture} from './live_server.js';
import {showDatabase} from './page_database.js';
import {addPictureOf} from './page_run.js';
import {addPicture} from './picture.js';

const field = (label, control) => h('label', null, `${label} `, control);

// The disparities of the board on a pair, beside the truth, with the waits over them.
export function makePictures(boardNow, fail) {
  const seed = h('input', {type: 'number', id: 'seed', min: 0, step: 1, value: 1});
  const files = ['left', 'right', 'truth'].map(
      side => h('input', {type: 'file', accept: 'image/*,.pfm,.pgm', id: `file-${side}`}));
  const scale = h('input', {type: 'number', id: 'truth-scale', min: 0, step: 'any', value: 1, size: 4});
  const fit = h('select', {id: 'fit'}, [
    ['', 'as they are'], ['crop', 'crop'], ['pad', 'pad']
  ].map(([value, text]) => h('option', {value}, text)));
  const shown = h('div');
  const state = h('p', {class: 'note', role: 'status'});
  let newest = null;  // the pictures that were asked for last
  const names = new Map();  // id of a picture that was sent -> that of its file
  async function show(pictures) {
    newest = pictures;
    fail(null);
    state.textContent = 'The board works on the pair …';
    const board = boardNow();
    try {
      const run = await ask('run', board, {source: 'preloaded', frames: 1, pictures});
      if (pictures !== newest) return;
      shown.replaceChildren();
      const group = addGroup(shown, 'The last frame');
      addPictureOf(group, run);
      const {truth, disparity, disparities} = run.pictures;
      const {accuracy, disparities_percent: answered} = run.stats;
      const texts = [
        `${fixed(answered, 2)} % of the pixels have a disparity`,
        accuracy &&
            `of the answers ${fixed(accuracy.bad_1_percent, 2)} % are off by more than 1, ${
                fixed(
                    accuracy.bad_2_percent,
                    2)} % by more than 2; ${percent(accuracy.answered_percent / 100)} are answered`
      ].filter(Boolean);
      const sets = board.sets.map(([key, value]) => `, ${key}: ${value}`).join('');
      state.textContent = `${texts.join('; ')}. The board: ${board.preset}${sets}.`;
      if (truth) {
        addPicture(group, {
          id: 'truth',
          title: 'The truth, beside the disparities',
          layers: [],
          frames: 1,
          names: ['truth', 'disparities'],
          pictures: [{url: truth, disparities}, {url: disparity, disparities}]
        });
      }
    } catch (error) {
      if (pictures !== newest) return;
      state.textContent = '';
      // The server names its own copy of a file.
      fail(new Error(error.message.replace(/'[^']*\/(\w+)'/g, (text, id) => names.get(id) ?? text)));
    }
  }
  async function sent(file) {
    const id = await sendPicture(file);
    names.set(id, file.name);
    return id;
  }
  async function showFiles() {
    const [left, right, truth] = files.map(({files: [file]}) => file);
    if (!left || !right) return fail(new Error('Choose a left and a right picture first.'));
    try {
      const pair = {left: await sent(left), right: await sent(right)};
      if (truth) Object.assign(pair, {truth: await sent(truth), truth_scale: Number(scale.value)});
      if (fit.value) pair.fit = fit.value;
      await show(pair);
    } catch (error) {
      fail(error);
    }
  }
  return h(
      'section', {class: 'card', 'aria-label': 'Pictures'},
      controls(
          field('synthetic scene, seed', seed),
          button('Show the scene', () => show({synthetic: Number(seed.value)}), {id: 'show-scene'})),
      controls(
          files.map((input, i) => field(['left', 'right', 'truth'][i], input)),
          field('levels a disparity', scale), field('size', fit),
          button('Show the pair', showFiles, {id: 'show-pair'})),
      note(
          'Pictures have the size of the board\'s images, or are cropped or padded to it.'),
      state, shown);
}

// Values with commas between them; a value may be a list or a map.
const valuesOf = text => {
  let depth = 0;
  return text.replace(/[,[\]{}]/g, sign => {
    depth += '[{'.includes(sign) - ']}'.includes(sign);
    return sign === ',' && depth === 0 ? '\n' : sign;
  }).split('\n').map(word => word.trim()).filter(Boolean);
};

// A sweep of one or two keys. now(): [board, source, frames].
export function makeSweep({keys}, now, open, fail) {
  const listed =
      h('datalist', {id: 'all-keys'}, keys.map(({key, meaning}) => h('option', {value: key}, meaning)));
  const lines = [1, 2].map(
      i =>
          [h('input', {
             type: 'text',
             list: 'all-keys',
             id: `sweep-key-${i}`,
             value: i === 1 ? 'matcher.window' : '',
             size: 24
           }),
           h('input',
             {type: 'text', id: `sweep-values-${i}`, value: i === 1 ? '3, 5, 7, 9, 11' : '', size: 24})]);
  const bar = h('progress', {hidden: true, 'aria-label': 'The points of the sweep'});
  const state = h('span', {role: 'status'});
  const shown = h('div');
  let controller = null;
  async function start() {
    controller?.abort();
    controller = new AbortController();
    const all = lines.map(([key, values]) => [key.value.trim(), valuesOf(values.value)]);
    if (all[0][0] === all[1][0]) return fail(new Error('Choose a key, or two different ones.'));
    const vary = Object.fromEntries(all.filter(([key]) => key));
    const [board, source, frames] = now();
    fail(null);
    bar.hidden = false;
    try {
      const {database} = await askLong(
          'sweep', board, {source, frames, vary}, controller.signal, (done, of, text) => {
            bar.max = of;
            bar.value = done;
            state.textContent = text;
          });
      state.textContent = '';
      shown.replaceChildren();
      showDatabase(shown, {database: {...database, path: 'the sweep'}}, open);
      shown.querySelector('.head .theme').remove();
    } catch (error) {
      state.textContent = '';
      if (error.name !== 'AbortError') fail(error);
    }
    bar.hidden = true;
  }
  return h(
      'section', {class: 'card', 'aria-label': 'Sweep'}, listed,
      lines.map(([key, values], i) => controls(field(i ? 'and key' : 'key', key), field('values', values))),
      controls(
          button('Sweep', start, {id: 'start-sweep'}), button('Stop', () => controller?.abort()), bar, state),
      note(
          'Values with commas between them. What is swept is what is shown: core or computer.'),
      shown);
}
