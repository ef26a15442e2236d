// Shows the data of the page.
import {h} from './dom.js';
import {showDatabase} from './page_database.js';
import {showLive} from './page_live.js';
import {showRun} from './page_run.js';
import {showTwoRuns} from './page_two.js';
import {startTooltips} from './tooltip.js';

// JSON, compressed by zlib, in base64.
const text = document.getElementById('data').textContent;
const bytes = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
const data =
    await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'))).json();
const page = document.getElementById('page');
startTooltips();
({run: showRun, two_runs: showTwoRuns, database: showDatabase, live: showLive})[data.kind](page, data);
page.append(h(
    'footer', {class: 'foot'},
    `Written by stereotlm ${data.version}. ${
        data.kind === 'live' ? 'Each figure is that of a run.' :
                               'The page is one file and needs no network.'}`));
