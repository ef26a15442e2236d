// The live page: a board that is changed in the browser, and what each change gives.
import {addChart, addHead, htmlTable} from './card.js';
import {button, choice, commandLine, controls, download, fileName, folded, h} from './dom.js';
import {headlineOf} from './findings.js';
import {count, gainText, percent, rate, shortened} from './format.js';
import {withFoldedLanes} from './lanes.js';
import {makeChart} from './live_chart.js';
import {differenceTable, figureCells} from './live_figures.js';
import {makeKeys} from './live_keys.js';
import {reportOf} from './live_report.js';
import {ask, askLong, boardFiles, boardOfFile, inTurn, Refused} from './live_server.js';
import {addressOf, boardOf, commandOf, History, movesOf, splitSet, withSets} from './live_state.js';
import {makePictures, makeSweep} from './live_tabs.js';
import {showDatabase} from './page_database.js';
import {addCards} from './page_run.js';

// ms without a change, after which the charts below follow: once both rates are known, and while one is not.
const kQuiet = 150;
const kLate = 1500;
const kViews = [['preloaded', 'the core alone'], ['camera', 'the whole computer']];

export function showLive(page, {live, database, version}) {
  const frames = {preloaded: live.core_frames, camera: live.computer_frames};
  const first = boardOf(location.hash) ?? {...live, sets: live.sets.map(splitSet)};
  const history =
      new History({preset: first.preset, sets: first.sets, calibration: first.calibration}, () => changed());
  const runs = {preloaded: null, camera: null};  // the newest answers: {board, run}
  let view = 'preloaded';
  let chartOf = null;  // the answer that the chart shows
  let isChartDue = false;
  let shown = null;  // the board that is asked for: that of the history, or while a buffer is dragged another
  let settled = {};  // of `runs` those of boards of the history
  let previous = {};    // the same before the last change
  let pinned = null;    // A: {board, runs}
  let gains = null;     // what `explain` has found: {address, source, knobs}
  let question = null;  // the controller of the open `explain`
  let isOutdated = false;  // it was ended by a change of the board

  // What the page is made of.
  addHead(page, {kind: 'live board', name: '', headline: ''});
  const [name, headline] = [page.querySelector('.top b'), page.querySelector('h1')];
  const figures = h('dl', {class: 'answers', id: 'figures'});
  const message = h('p', {class: 'bad', id: 'message', role: 'alert', tabindex: '0'});
  const keys = makeKeys(live, set, openError);
  const chart = makeChart({
    place: (buffer, bank, isNew) => showBoard(buffer ? moved(buffer, bank, isNew) : history.board),
    drop: (buffer, bank, isNew) => history.show(moved(buffer, bank, isNew))
  });
  const cards = h('div', {id: 'cards'});
  const gainsHost = h('div', {id: 'gains'});
  const command = h('div', {id: 'command'});
  const undo = button('Undo', () => history.step(-1), {id: 'undo', title: 'Ctrl-Z'});
  const redo = button('Redo', () => history.step(1), {id: 'redo', title: 'Ctrl-Y'});
  const pin = button('Pin as A', pinOrNot, {id: 'pin', 'aria-pressed': 'false'});
  const explain = button('What gains most?', askGains, {id: 'explain'});
  const boards = h('select', {id: 'boards', change: event => openNamed(event.target)});
  const file = h('input', {
    type: 'file',
    accept: '.yaml',
    id: 'board-file',
    'aria-label': 'Open a board file',
    change: async event => {
      const [chosen] = event.target.files;
      if (!chosen) return;
      await openYaml(await chosen.text());
      event.target.value = '';  // so that the same file may be opened again
    }
  });
  const saved = h('span', {class: 'note', id: 'saved', role: 'status'});
  const saveAs =
      h('input',
        {type: 'text', id: 'save-name', value: 'board.yaml', size: 14, 'aria-label': 'Name of the file'});
  const tools = controls(
      undo, redo, h('label', null, 'board ', boards),
      h('label', null, 'shown ', choice('view', kViews, view, chosen => {
          view = chosen;
          draw();
        })), pin, explain);
  const exports = folded(
      'Open, save, share',
      controls(
          h('label', null, 'open a file ', file),
          button(
              'Copy link',
              async event => {
                const {target} = event;
                const isCopied =
                    await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
                target.textContent = `${isCopied ? 'Copied' : 'Copy it'}: it is the address of this page`;
              },
              {id: 'copy-link'}),
          button(
              'Board as YAML',
              () =>
                  current() &&
                  download(
                      `${fileName(current().run.stats.board)}.yaml`, 'text/yaml', current().run.config_yaml),
              {id: 'yaml'}),
          button(
              'Report',
              async () => current() && download('report.html', 'text/html', await reportOf({
                                                  format: 2,
                                                  version,
                                                  kind: 'run',
                                                  text: '',
                                                  run: {
                                                    folder: 'the live board',
                                                    command: commandOf(current().board, view, frames[view]),
                                                    ...current().run,
                                                    knobs: current().run.knobs
                                                  }
                                                })),
              {id: 'report'}),
          saveAs, button('Save in the folder', save, {id: 'save'}), saved),
      command);
  const board = h('div', {class: 'live'}, h('div', {class: 'cards'}, chart.element), keys.element);
  const pictures = makePictures(() => history.board, openError);
  const sweep = makeSweep(live, () => [history.board, view, frames[view]], openYaml, openError);
  const tabs = [
    ['board', 'The board', [board, gainsHost, cards]], ['pictures', 'Pictures', [pictures]],
    ['sweep', 'Sweep', [sweep]]
  ];
  if (database) {
    const points = h('div');
    tabs.push(['database', 'Database', [points]]);
    showDatabase(points, {database}, openYaml);
    points.querySelector('.head .theme').remove();
  }
  const panels = tabs.map(
      ([id, , children]) =>
          h('div', {id: `tab-${id}`, role: 'tabpanel', 'aria-labelledby': `to-${id}`}, children));
  const buttons = tabs.map(
      ([id, text], i) =>
          h('button',
            {type: 'button', role: 'tab', id: `to-${id}`, 'aria-controls': `tab-${id}`, click: () => open(i)},
            text));
  function open(chosen) {
    panels.forEach((panel, i) => panel.toggleAttribute('hidden', i !== chosen));
    buttons.forEach((tab, i) => {
      tab.setAttribute('aria-selected', String(i === chosen));
      tab.tabIndex = i === chosen ? 0 : -1;
    });
  }
  const list =
      h('div', {
        class: 'tabs',
        role: 'tablist',
        keydown: event => {
          const step = {ArrowRight: 1, ArrowLeft: -1}[event.key];
          if (!step) return;
          const next = (buttons.indexOf(document.activeElement) + step + buttons.length) % buttons.length;
          open(next);
          buttons[next].focus();
        }
      },
        buttons);
  const unfold = h('details', {class: 'more'}, h('summary', null, 'What these figures mean'));
  page.append(tools, exports, message, unfold, figures, list, ...panels);
  open(database && !boardOf(location.hash) ? tabs.length - 1 : 0);
  boards.append(
      h('option', {value: ''}, 'choose'),
      h('optgroup', {label: 'presets'}, live.presets.map(preset => h('option', {value: preset}, preset))));
  boardFiles()
      .then(
          files => files.length &&
              boards.append(
                  h('optgroup', {label: 'board files'},
                    files.map(path => h('option', {value: `./${path}`}, path)))))
      .catch(openError);
  addEventListener('keydown', event => {
    if (!(event.ctrlKey || event.metaKey) || /^(INPUT|TEXTAREA)$/.test(event.target.tagName)) return;
    const by = {z: event.shiftKey ? 1 : -1, y: 1}[event.key.toLowerCase()];
    if (!by) return;
    event.preventDefault();
    history.step(by);
  });

  const current = () => runs[view] ?? runs.preloaded;
  const isOf = (answer, its) => answer && addressOf(answer.board) === addressOf(its);

  // Changes of the board.
  function set(changes) {
    history.show(withSets(history.board, changes));
    return history.board;
  }
  function moved(buffer, bank, isNew) {
    const {settings} = (runs.preloaded ?? runs.camera).run;
    const more = isNew ? [[`ssram.banks.${bank}`, '{}']] : [];
    return withSets(history.board, [...more, ...movesOf(settings, buffer, bank)]);
  }
  async function openYaml(text) {
    try {
      const {preset, sets} = await boardOfFile(text);
      history.show({preset, sets: sets.map(splitSet), calibration: ''});
      open(0);
    } catch (error) {
      openError(error);
    }
  }
  async function openNamed(select) {
    const {value} = select;
    select.value = '';
    try {
      const {preset, sets} = await ask('check', {preset: value, sets: []});
      history.show({preset, sets: sets.map(splitSet), calibration: ''});
    } catch (error) {
      openError(error);
    }
  }
  async function save() {
    saved.textContent = '';
    try {
      const {path} = await ask('save', history.board, {name: saveAs.value});
      message.textContent = '';
      saved.textContent = `Saved: ${path}`;
    } catch (error) {
      openError(error);
    }
  }
  // null: nothing has gone wrong.
  function openError(error) {
    message.textContent = error?.message ?? '';
  }

  // Questions. The answers of all boards of a drag are shown; those of the board itself stay.
  function answered(source) {
    return (its, run) => {
      run.isLive = true;
      runs[source] = {board: its, run};
      if (isOf(runs[source], history.board)) settled = {...settled, [source]: runs[source]};
      message.textContent = '';
      // The computer is asked behind the core, so that the core's answer is not kept waiting.
      if (source === 'preloaded' && isOf(runs.preloaded, history.board)) askComputer(history.board);
      drawFigures();
      if (source === view) drawChartSoon();
      askWhenQuiet();
    };
  }
  function failed(its, error) {
    if (!isOf({board: its}, shown)) return;
    page.classList.add('refused');
    // A text above the chart would move the banks away from the pointer.
    if (!isOf({board: its}, history.board)) return chart.refuse(error.message);
    if (!(error instanceof Refused)) return openError(error);
    keys.refuse(error.problems, its);
    const how = history.canUndo ? '; Undo takes the change back. ' : ': ';
    message.textContent = `This board is refused${how}${error.message}`;
  }
  const more = source => ({source, frames: frames[source]});
  const askCore = inTurn(
      (its, signal) => ask('run', its, {...more('preloaded'), record: false}, signal), answered('preloaded'),
      failed);
  const askComputer = inTurn(
      (its, signal) => ask('run', its, {...more('camera'), record: false}, signal), answered('camera'),
      failed);
  let drawn = '';  // the board and the view of the cards
  const askCards = inTurn(
      ([its, source], signal) => ask('run', its, {...more(source), record: true}, signal),
      ([its, source], run) => isOf({board: its}, history.board) && source === view &&
          drawn !== `${source} ${addressOf(its)}` && drawCards(its, run),
      ([its], error) => failed(its, error));
  let quiet = 0;
  function askWhenQuiet() {
    clearTimeout(quiet);
    const wanted = `${view} ${addressOf(history.board)}`;
    quiet = setTimeout(() => {
      window.history.replaceState(null, '', addressOf(history.board));
      if (wanted !== drawn) askCards([history.board, view]);
    }, isOf(runs.preloaded, history.board) && isOf(runs.camera, history.board) ? kQuiet : kLate);
  }

  function showBoard(its) {
    shown = its;
    page.classList.remove('refused');
    askCore(its);
    // Other texts do not move the banks away from the pointer.
    figures.style.height = its === history.board ? '' : `${figures.getBoundingClientRect().height}px`;
    markWaiting();
  }
  function changed() {
    previous = settled;
    isOutdated = Boolean(question);
    question?.abort();
    message.textContent = '';
    keys.refuse([], history.board);
    showBoard(history.board);
    undo.disabled = !history.canUndo;
    redo.disabled = !history.canRedo;
    if (isOf(runs.preloaded, history.board)) draw();
    askWhenQuiet();
  }

  // Drawing.
  function markWaiting() {
    for (const cell of figures.children) {
      const answer = runs[cell.dataset.source];
      cell.classList.toggle('stale', !isOf(answer, shown));
      // While a buffer is held, the computer is not asked.
      const isAsked = shown === history.board || cell.dataset.source === 'preloaded';
      cell.querySelector('.state').textContent =
          isOf(answer, shown) ? '' : isAsked ? ' …' : ', before';
    }
    chart.element.classList.toggle('stale', isChartDue || chartOf !== runs[view] || !isOf(chartOf, shown));
    cards.classList.toggle('stale', drawn !== `${view} ${addressOf(history.board)}`);
  }
  function draw() {
    drawFigures();
    drawChartSoon();
  }
  // The figures are on the screen before the chart is drawn, which takes longer.
  function drawChartSoon() {
    if (!isChartDue) requestAnimationFrame(() => setTimeout(drawChart));
    isChartDue = true;
  }
  function drawFigures() {
    figures.replaceChildren(...figureCells(runs, pinned?.runs));
    markWaiting();
  }
  function drawChart() {
    isChartDue = false;
    const before = pinned?.runs ?? (shown === history.board ? previous : settled);
    const its = runs[view];
    if (!its) return;
    const run = withFoldedLanes(its.run);
    chart.show(run, before[view]?.run && withFoldedLanes(before[view].run), pinned ? 'A' : 'before');
    chartOf = its;
    if (isOf(its, history.board)) {
      name.textContent = run.stats.board;
      headline.textContent = headlineOf(run);
      document.title = `${run.stats.board}: ${headlineOf(run)}`;
      keys.show(its.run.settings);
      command.replaceChildren(commandLine(commandOf(history.board, view, frames[view])));
    }
    markWaiting();
    askWhenQuiet();
  }
  function drawCards(its, run) {
    drawn = `${view} ${addressOf(its)}`;
    Object.assign(run, {isLive: true, command: commandOf(its, view, frames[view])});
    const has = gains && gains.address === addressOf(its) && gains.source === view;
    if (has) run.knobs = gains.knobs;
    runs[view].run = run;
    cards.style.minHeight = `${cards.offsetHeight}px`;
    cards.replaceChildren();
    addCards(cards, run);
    if (pinned?.runs[view]) {
      const table = differenceTable(pinned.runs[view].run, run);
      addChart(cards, {
        id: 'differences',
        title: `${count(table[1].length, 'figure')} of stats.json differ from A`,
        body: htmlTable(table[0], table[1].map(row => row.map(shortened))),
        numbers: () => table
      });
    }
    requestAnimationFrame(() => requestAnimationFrame(() => {
                            cards.style.minHeight = '';
                          }));
    if (!question) drawGains();
    markWaiting();
  }
  function pinOrNot() {
    pinned = pinned ? null : {board: history.board, runs: {...runs}};
    pin.textContent = pinned ? 'Let A go' : 'Pin as A';
    pin.setAttribute('aria-pressed', String(Boolean(pinned)));
    drawn = '';
    draw();
  }

  // What each single change gains.
  async function askGains() {
    openError(null);
    isOutdated = false;
    question?.abort();
    const controller = question = new AbortController();
    const bar = h('progress', {'aria-label': 'Single changes are tried'});
    const text = h('span');
    gainsHost.replaceChildren(controls(bar, text, button('Stop', () => controller.abort())));
    open(0);
    gainsHost.scrollIntoView({block: 'center'});
    const [its, source] = [history.board, view];
    try {
      const knobs = await askLong('explain', its, {source}, controller.signal, (done, of, said) => {
        bar.max = of;
        bar.value = done;
        text.textContent = said;
      });
      gains = {address: addressOf(its), source, knobs};
      drawn = '';
      askWhenQuiet();
    } catch (error) {
      if (error.name !== 'AbortError') openError(error);
    }
    if (controller === question) question = null;
    if (!question) drawGains();
  }
  function drawGains() {
    gainsHost.replaceChildren(
        isOutdated ? h('p', {class: 'note', role: 'status'},
                       'The board has changed meanwhile: ask again what gains most.') :
                     '');
    if (gains?.address !== addressOf(history.board)) return;
    const {knobs, source} = gains;
    const kMost = 8;
    const best = knobs.changes.filter(({gained_percent: gained}) => gained > 0.05).slice(0, kMost);
    const rows = best.map(
        step =>
            [button('Apply', () => set(step.sets.map(splitSet))), `${step.key}: ${step.from} → ${step.to}`,
             rate(step.frames_per_second), gainText(step.gained_percent / 100),
             percent(step.area.slices_percent / 100), [
               step.changes_disparities && 'changes the disparities', step.loses_pixels && 'loses pixels'
             ].filter(Boolean).join(', ')]);
    const group = h('div', {class: 'cards'});
    addChart(group, {
      id: 'best-changes',
      wide: true,
      title: best.length ? 'The single changes that gain most' : 'No single change gains frames',
      body: htmlTable(['', 'change', 'frames/s', 'gain', 'slices', ''], rows),
      note: `Of ${count(knobs.changes.length, 'change')}, for ${new Map(kViews).get(source)}. While it ` +
          'is shown, all are below, under what to change.'
    });
    gainsHost.replaceChildren(group);
  }

  changed();
}
