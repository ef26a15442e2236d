// The page of one run.
import {addArea} from './chart_area.js';
import {addAudit} from './chart_audit.js';
import {addBlame} from './chart_blame.js';
import {addBounds} from './chart_bounds.js';
import {addConfiguration, commandLine} from './chart_config.js';
import {addFrames} from './chart_frames.js';
import {addKnobs, addRoofline} from './chart_knobs.js';
import {addLatency} from './chart_latency.js';
import {addMemory} from './chart_memory.js';
import {addPicture} from './chart_picture.js';
import {addRows} from './chart_rows.js';
import {addBankUse, addPortStates} from './chart_states.js';
import {addTimeLine} from './chart_time.js';
import {h} from './dom.js';
import {answersOf, headlineOf, settingOf, waitingRows} from './findings.js';
import {count} from './format.js';
import {addAnswers, addGroup, addHead} from './page_parts.js';
import {linesOf, tilesOf} from './recording.js';

// The waits over the picture and its disparities, or over grey where the run has computed no pixels.
function addPictureOf(page, run) {
  const layers = tilesOf(run);
  if (!run.pictures && layers.length === 0) return;
  const {stats} = run;
  const {left, disparity, disparities} = run.pictures ?? {};
  const [width, height] = ['image.width', 'image.height'].map(key => settingOf(run, key));
  addPicture(page, {
    title: layers.length ? `Ports wait ${waitingRows(run)}` : 'The picture and its disparities',
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
    frames: linesOf(run)?.frames ?? stats.frames,
    names: left ? ['picture', 'disparities'] : ['disparities']
  });
}

export function showRun(page, {run}) {
  const {stats} = run;
  addHead(page, {
    kind: 'run',
    name: stats.board,
    headline: headlineOf(run),
    sub: [
      h('p', {class: 'note'},
        `${run.folder} · ${count(stats.frames, 'frame')} · ` +
            (stats.cameras ? 'the whole computer, with cameras' : 'the core alone, fed by an ideal host')),
      commandLine(run.command)
    ]
  });
  addAnswers(page, answersOf(run));

  addMemory(addGroup(page, 'The board and its traffic'), run);
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
  addKnobs(change, run);
  addArea(change, run);

  const trust = addGroup(page, 'The figures');
  addAudit(trust, run);
  addConfiguration(trust, run);
}
