// What all pages have: the head line, the answers, groups of charts.
import {h} from './dom.js';
import {themeSwitch} from './theme.js';

// The sign stays in the line of its number.
const unbroken = text => text.replaceAll(' %', '\u00a0%');

export function addHead(page, {kind, name, headline, sub}) {
  document.title = `${name}: ${headline}`;
  page.append(
      h('header', {class: 'head'},
        h('div', {class: 'top'}, h('span', null, `stereotlm ${kind}`), h('b', null, name), themeSwitch()),
        h('h1', null, unbroken(headline)), sub));
}

export function addAnswers(page, answers) {
  page.append(
      h('dl', {class: 'answers'},
        answers.map(
            ([question, texts]) =>
                h('div', null, h('dt', null, question),
                  texts.filter(Boolean).map(text => h('dd', null, unbroken(text)))))));
}

// A heading, and below it the place of charts.
export function addGroup(page, title) {
  const group = h('div', {class: 'cards'});
  page.append(h('h2', {class: 'group'}, title), group);
  return group;
}
