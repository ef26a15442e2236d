// Shows the data of the page.
import {h} from './dom.js';
import {showDatabase} from './page_database.js';
import {showRun} from './page_run.js';
import {showTwoRuns} from './page_two.js';
import {startTooltips} from './tooltip.js';

const data = JSON.parse(document.getElementById('data').textContent);
const page = document.getElementById('page');
startTooltips();
({run: showRun, two_runs: showTwoRuns, database: showDatabase})[data.kind](page, data);
page.append(
    h('footer', {class: 'foot'},
      `Written by stereotlm ${data.version}. The page is one file and needs no network.`));
