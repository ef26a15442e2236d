// The page of one run.
import {addAnswers, addChart, addGroup, addHead, htmlTable} from './card.js';
import {addArea, addKnobs} from './changes.js';
import {linesOf, tilesOf} from './data.js';
import {commandLine, fileName, folded, h, note, textBox} from './dom.js';
import {answersOf, headlineOf, settingOf, waitingRows} from './findings.js';
import {count, value} from './format.js';
import {laneNote, withFoldedLanes} from './lanes.js';
import {addBankUse, addBounds, addFrames, addPortStates, addRoofline} from './limits.js';
import {addMemory} from './memory.js';
import {addPicture} from './picture.js';
import {addLatency, addTimeLine} from './time.js';
import {addBlame, addRows} from './waits.js';

// The waits over the picture and its disparities, or over grey where the run has computed no pixels.
export function addPictureOf(page, run) {
  const layers = tilesOf(run);
  if (!run.pictures && layers.length === 0) return;
  const {left, disparity, disparities} = run.pictures ?? {};
  const [width, height] = ['image.width', 'image.height'].map(key => settingOf(run, key));
  addPicture(page, {
    title: layers.length ? `On the picture, ports wait ${waitingRows(run)}` :
                           'The picture and its disparities',
    layers,
    note: [
      layers.length     ? 'Colour: cycles in which ports wait, at the place whose results come next.' :
          run.recording ? 'No port waits in any row of the picture.' :
                          '',
      run.pictures ?
          'Below is the last frame: disparities from dark (far) to bright (near); black: no answer.' :
          'The run has computed no pixels.'
    ].join(' '),
    pictures:
        [left && {url: left}, disparity ? {url: disparity, disparities} : {width, height}].filter(Boolean),
    frames: linesOf(run)?.frames ?? run.stats.frames,
    names: left ? ['picture', 'disparities'] : ['disparities']
  });
}

// The identities among the figures, with both sides.
function addAudit(page, {identities}) {
  const names = ['figure', 'value', 'equals', 'value'];
  addChart(page, {
    id: 'audit',
    wide: true,
    title: `All ${identities.length} identities hold`,
    note: 'They were checked when stats.json was read.',
    body: folded('Both sides of each', htmlTable(names, identities)),
    numbers: () => [names, identities]
  });
}

// The board, every key, and the files of the run.
function addConfiguration(page, run) {
  const names = ['key', 'value', 'unit', 'meaning'];
  const rows = run.settings.map(({key, value: its, unit, meaning}) => [key, its, unit ?? '', meaning ?? '']);
  const host = h('div');
  const show = wanted => host.replaceChildren(htmlTable(
      names,
      rows.filter(([key, its, ,
                    meaning]) => `${key} ${its} ${meaning}`.toLowerCase().includes(wanted.toLowerCase()))
          .map(([key, its, ...others]) => [key, value(its), ...others])));
  show('');
  addChart(page, {
    id: 'configuration',
    wide: true,
    title: `The board ${run.stats.board}`,
    note: 'Every key with its value, and the board file as it was run.',
    body: [
      h('label', {class: 'search'}, 'Search ',
        h('input', {type: 'search', id: 'search-keys', input: event => show(event.target.value)})),
      host, folded('config.yaml', textBox(run.config_yaml, `${fileName(run.stats.board)}.yaml`)),
      folded('stats.json', textBox(JSON.stringify(run.stats, null, 2), 'stats.json'))
    ],
    numbers: () => [names, rows]
  });
}

export function showRun(page, {run: all}) {
  const run = withFoldedLanes(all);
  const {stats} = run;
  addHead(page, {
    kind: 'run',
    name: stats.board,
    headline: headlineOf(run),
    sub: [
      note(
          `${run.folder} · ${count(stats.frames, 'frame')} · ` +
          (stats.cameras ? 'the whole computer, with cameras' : 'the core alone, fed by an ideal host')),
      laneNote(all),
      commandLine(run.command)
    ]
  });
  addAnswers(page, answersOf(run));

  addMemory(addGroup(page, 'The board and its traffic'), [run]);
  addCards(page, all);
}

// All charts of a run but the memory chart.
export function addCards(page, all) {
  const run = withFoldedLanes(all);
  const {stats} = run;
  const limits = addGroup(page, 'What limits');
  addBounds(limits, run);
  addRoofline(limits, run);
  addBankUse(limits, run);

  const waits = addGroup(page, 'Who waits for whom, where and when');
  addBlame(waits, run);
  addPortStates(waits, run);
  addRows(waits, run);
  addPictureOf(waits, run);
  addFrames(waits, [['', stats.frame_cycles, '--blue']], settingOf(run, 'fpga.clock_mhz'));
  if (stats.cameras) {
    const computer = addGroup(page, 'The computer around the board');
    addTimeLine(computer, run);
    addLatency(computer, run);
  }
  const change = addGroup(page, 'What to change, and what it costs');
  if (run.knobs || !run.isLive) addKnobs(change, run);
  addArea(change, run);

  const trust = addGroup(page, 'The figures');
  addAudit(trust, run);
  addConfiguration(trust, all);
}
