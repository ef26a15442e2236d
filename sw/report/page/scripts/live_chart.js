// The memory chart of the live page: its buffers are dragged into other banks, or carried there by keys.
import {h, s} from './dom.js';
import {bankText, fixed} from './format.js';
import {bankNames, newBankName} from './live_state.js';
import {addMemory, linksOf} from './memory.js';
import {hideTooltip, mark} from './tooltip.js';

const kDrags = 4;           // pixels that the pointer moves before a buffer is dragged
const kLeastChange = 0.05;  // MB/s
const kMostChanges = 6;     // that are named
const kNewBank = '#new';
const kHint = 'Drag a buffer into another bank; by keys: go to it with the arrows, Enter, arrows, Enter.';

const labelOf = buffer => buffer.dataset.key.replace('allocation.', '');
const bankOf = element => element?.closest?.('.block[id^="bank-"]')?.id.slice('bank-'.length);

// name -> MB/s of the links of a run; null: of none. Taken from the text of its drawing: to make elements of
// it takes too long.
const ratesOf = run => new Map(
    [...(run?.memory_chart ?? '')
         .matchAll(/ data-from="\w+-([^"]*)" data-to="\w+-([^"]*)" data-peak="[^"]*" data-mbps="([^"]*)"/g)]
        .map(([, from, to, rate]) => [`${from} – ${to}`, Number(rate)]));

// The links whose rates differ: [[name, before, now], ..].
function changedLinks(before, now) {
  if (!before) return [];
  const [old, its] = [before, now].map(ratesOf);
  return [...new Set([...old.keys(), ...its.keys()])]
      .map(name => [name, old.get(name) ?? 0, its.get(name) ?? 0])
      .filter(([, a, b]) => Math.abs(b - a) >= kLeastChange);
}

// place(buffer, bank): shows the board with the buffer in that bank, without keeping it; null: the board as
// it is. drop(buffer, bank, isNew): keeps it. Returns {show, refuse, element}.
export function makeChart({place, drop}) {
  const status = h('p', {class: 'note', id: 'chart-status', 'aria-live': 'polite'});
  const target = h('div', {class: 'new-bank', id: 'new-bank'}, 'Drop a buffer here: into a new bank');
  const changes = h('p', {class: 'note', id: 'chart-changes'});
  const group = h('div');
  const told = h('div', {class: 'told'}, status, changes);
  const element = h('div', {class: 'live-chart'}, group, target, told);
  const ghost = h('div', {class: 'ghost', hidden: true});
  document.body.append(ghost);
  let run = null;
  let held = null;      // {key, label, from, bank, x, y, isDragged, byKeys}
  let kept = null;      // the key of the buffer that had the focus
  let waiting = null;   // what show() was given meanwhile

  const nameOf = bank => bank === kNewBank ? `a new bank, ${newBankName(run.settings)}` : bankText(bank);
  const blocks = () => [...group.querySelectorAll('.block[id^="bank-"]')];
  function over(bank) {
    if (bank === held.bank) return;
    held.bank = bank;
    for (const block of blocks()) block.classList.toggle('over', bankOf(block) === bank);
    target.classList.toggle('over', bank === kNewBank);
    status.textContent = bank ? `${held.label}: ${nameOf(bank)}` : `${held.label}: nowhere`;
    const isElsewhere = bank && bank !== held.from;
    const name = bank === kNewBank ? newBankName(run.settings) : bank;
    place(...isElsewhere ? [held.key, name, bank === kNewBank] : [null]);
  }
  function end(isDropped) {
    const {key, from, bank, label} = held;
    held = null;
    ghost.hidden = true;
    document.body.classList.remove('dragging');
    told.classList.remove('held');
    for (const block of blocks()) block.classList.remove('over');
    target.classList.remove('over');
    const moves = isDropped && bank && bank !== from;
    status.textContent = moves ? `${label} is in ${nameOf(bank)}.` : '';
    kept = key;
    if (moves)
      drop(key, bank === kNewBank ? newBankName(run.settings) : bank, bank === kNewBank);
    else
      place(null);
    if (waiting) show(...waiting);
  }

  group.addEventListener('pointerdown', event => {
    const buffer = event.target.closest('.buffer');
    if (!buffer || event.button !== 0 || !run) return;
    event.preventDefault();
    buffer.focus({preventScroll: true});
    const from = bankOf(buffer);
    held = {
      key: buffer.dataset.key,
      label: labelOf(buffer),
      from,
      bank: from,
      x: event.clientX,
      y: event.clientY
    };
  });
  addEventListener('pointermove', event => {
    if (!held || held.byKeys) return;
    if (!held.isDragged && Math.hypot(event.clientX - held.x, event.clientY - held.y) < kDrags) return;
    held.isDragged = true;
    document.body.classList.add('dragging');
    told.classList.add('held');
    hideTooltip();
    ghost.hidden = false;
    ghost.textContent = held.label;
    ghost.style.left = `${event.clientX + 10}px`;
    ghost.style.top = `${event.clientY + 8}px`;
    const below = document.elementFromPoint(event.clientX, event.clientY);
    over(below?.closest('#new-bank') ? kNewBank : bankOf(below));
  });
  addEventListener('pointerup', () => held && !held.byKeys && end(held.isDragged));
  addEventListener('pointercancel', () => held && end(false));
  addEventListener('blur', () => held?.isDragged && end(false));
  addEventListener('keydown', event => {
    if (held && event.key === 'Escape') end(false);
  });
  group.addEventListener('keydown', event => {
    const buffer = event.target.closest?.('.buffer');
    if (!buffer || !run) return;
    const take = () => {
      event.preventDefault();
      event.stopPropagation();
    };
    if (event.key === 'Enter' || event.key === ' ') {
      take();
      if (held) return end(true);
      const from = bankOf(buffer);
      held = {key: buffer.dataset.key, label: labelOf(buffer), from, bank: from, byKeys: true};
      told.classList.add('held');
      status.textContent =
          `${held.label} is held: choose a bank with the arrows, then Enter. Escape: leave it.`;
    } else if (held && event.key.startsWith('Arrow')) {
      take();
      const banks = [...bankNames(run.settings), kNewBank];
      const step = event.key === 'ArrowDown' || event.key === 'ArrowRight' ? 1 : -1;
      over(banks[(banks.indexOf(held.bank) + step + banks.length) % banks.length]);
    }
  }, true);
  group.addEventListener('focusout', () => held?.byKeys && setTimeout(() => {
                                             if (held?.byKeys && !group.contains(document.activeElement))
                                               end(false);
                                           }));

  function listChanges(links) {
    const texts =
        links.slice(0, kMostChanges).map(([name, a, b]) => `${name} ${fixed(a, 1)} → ${fixed(b, 1)}`);
    changes.textContent = links.length === 0 ?
        '' :
        `Links that change, MB/s: ${texts.join('; ')}${
            links.length > kMostChanges ? `; and ${links.length - kMostChanges} more` : ''}.`;
  }

  // Draws the run. While a buffer is held the drawing stays as it is, and only the changed links are named.
  // `with_`: the run with which links are compared; null: none. `name`: of that.
  function show(its, with_, name) {
    if (held) {
      waiting = [its, with_, name];
      return listChanges(changedLinks(run, its));
    }
    waiting = null;
    run = its;
    const focused = document.activeElement?.closest?.('.buffer')?.dataset.key ?? kept;
    const hadFocus = group.contains(document.activeElement) ||
        (kept !== null && document.activeElement === document.body);
    const left = group.querySelector('.memory')?.scrollLeft;
    group.style.minHeight = `${group.offsetHeight}px`;
    group.replaceChildren();
    const links = changedLinks(with_, run);
    const before = ratesOf(with_);
    addMemory(
        group, [run],
        link => before.has(link.name) ? [`${name}: ${fixed(before.get(link.name), 1)} MB/s`] : [], kHint);
    const svg = group.querySelector('svg.memory-chart');
    const changed = new Set(links.map(([link]) => link));
    for (const link of linksOf(svg)) link.element.classList.toggle('changed', changed.has(link.name));
    for (const buffer of svg.querySelectorAll('.buffer')) {
      const box = buffer.getBBox();
      buffer.prepend(s('rect', {
        x: box.x - 4,
        y: box.y - 1,
        width: box.width + 8,
        height: box.height + 2,
        rx: 3,
        class: 'handle'
      }));
      const texts = [...buffer.querySelectorAll('text')].map(text => text.textContent).join(' ');
      const how = 'drag it, or press Enter, to move it';
      mark(buffer, [`${texts} words`, bankText(bankOf(buffer)), how]).setAttribute('role', 'button');
      buffer.closest('.block').setAttribute('role', 'group');
    }
    if (left !== undefined) group.querySelector('.memory').scrollLeft = left;
    group.style.minHeight = '';
    if (hadFocus && focused)
      group.querySelector(`.buffer[data-key="${CSS.escape(focused)}"]`)?.focus({preventScroll: true});
    kept = null;
    listChanges(links);
  }
  // Says why the board is refused that the held buffer would give.
  function refuse(why) {
    if (held) status.textContent = `${held.label}: not into ${nameOf(held.bank)}: ${why}`;
  }
  return {show, refuse, element};
}
