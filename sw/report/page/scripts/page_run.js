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
import {addPicture, layersOf} from './chart_picture.js';
import {addRows} from './chart_rows.js';
import {addBankUse, addPortStates} from './chart_states.js';
import {addTimeLine} from './chart_time.js';
import {h} from './dom.js';
import {answersOf, headlineOf, settingOf} from './findings.js';
import {addAbsent, addAnswers, addGroup, addHead} from './page_parts.js';

export function showRun(page, {run}) {
  const {stats} = run;
  const absent = run.record_command ? `Not recorded in this run. To record it: ${run.record_command}` :
                                      'Not recorded in this run.';
  addHead(page, {
    kind: 'run',
    name: stats.board,
    headline: headlineOf(run),
    sub: [
      h('p', {class: 'note'},
        `${run.folder} · ${stats.frames} frames · ` +
            (stats.cameras ? 'the whole computer, with cameras' : 'the core alone, fed by an ideal host')),
      commandLine(run.command)
    ]
  });
  addAnswers(page, answersOf(run));

  if (run.memory_chart) addMemory(addGroup(page, 'The board and its traffic'), run);
  const limits = addGroup(page, 'What limits');
  addBounds(limits, run);
  addRoofline(limits, run);
  if (!run.memory_chart) addMemory(limits, run);
  addBankUse(limits, run);

  const waits = addGroup(page, 'Who waits for whom, where and when');
  addBlame(waits, run);
  addPortStates(waits, run);
  addRows(waits, run);
  if (run.pictures) {
    const {left, disparity, disparities} = run.pictures;
    addPicture(waits, {
      title: layersOf(run).length ? 'Stalls, painted over the picture' :
                                    'The picture and its disparities: no stalls to paint',
      layers: layersOf(run),
      note: `The last frame${
                run.recording?.tiles ? ' of the run.' :
                                       ` of the run. ${
                                           run.rows ? `Stalls by row; by column: ${absent}` :
                                                      'Stalls are left out by --quick.'}`} ` +
          'Disparities from dark (far) to bright (near); black: no answer.',
      pictures: left ? [{url: left}, {url: disparity, disparities}] : [{url: disparity, disparities}],
      names: left ? ['picture', 'disparities'] : ['disparities']
    });
  }
  addFrames(waits, [['', stats.frame_cycles, '--blue']], settingOf(run, 'fpga.clock_mhz'));
  if (stats.cameras) {
    const computer = addGroup(page, 'The computer around the board');
    addTimeLine(computer, run, addAbsent(absent));
    addLatency(computer, run, run.recording?.latency ? '' : `How much of it is waiting: ${absent}`);
  }
  const change = addGroup(page, 'What to change, and what it costs');
  addKnobs(change, run);
  addArea(change, run);

  const trust = addGroup(page, 'The figures');
  addAudit(trust, run);
  addConfiguration(trust, run);
}
