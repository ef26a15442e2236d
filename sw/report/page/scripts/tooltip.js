// One tooltip for the page, for the mark under the pointer or with the focus; and the keys that move the
// focus from mark to mark of a chart.
import {h} from './dom.js';

const tooltip = h('div', {id: 'tooltip', role: 'status', hidden: true});
const tooltipTexts = new WeakMap();

// Shows lines of text at a place of the window; the first is the heading.
export function showTooltip(lines, x, y) {
  tooltip.replaceChildren(...lines.map((line, i) => h(i === 0 ? 'b' : 'div', null, line)));
  tooltip.hidden = false;
  const {width, height} = tooltip.getBoundingClientRect();
  const right = document.documentElement.clientWidth - width - 8;
  tooltip.style.left = `${Math.max(8, Math.min(x + 14, right))}px`;
  tooltip.style.top = `${y + height + 24 > innerHeight ? Math.max(4, y - height - 12) : y + 16}px`;
}
export const hideTooltip = () => {
  tooltip.hidden = true;
};

// Makes an element a mark: `lines` are the lines of its tooltip, and its name for a screen reader.
export function mark(element, lines) {
  tooltipTexts.set(element, lines);
  element.classList.add('mark');
  element.setAttribute('role', 'img');
  element.setAttribute('aria-label', lines.join(', '));
  element.setAttribute('tabindex', '-1');
  return element;
}

// The first mark of a chart takes part in the order of tabs; arrow keys go to its neighbours.
export function linkMarks(host) {
  const marks = [...host.querySelectorAll('.mark')].filter(element => !element.closest('[hidden]'));
  if (marks.length === 0) return;
  marks[0].setAttribute('tabindex', '0');
  host.onkeydown = event => {
    const place = marks.indexOf(document.activeElement);
    const step = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[event.key];
    if (place < 0 || !step) return;
    event.preventDefault();
    marks[Math.max(0, Math.min(marks.length - 1, place + step))].focus();
  };
}

export function startTooltips() {
  document.body.append(tooltip);
  const linesOf = event => tooltipTexts.get(event.target.closest?.('.mark'));
  document.addEventListener('pointermove', event => {
    const lines = linesOf(event);
    if (lines)
      showTooltip(lines, event.clientX, event.clientY);
    else if (!event.target.closest?.('.hovers'))
      hideTooltip();
  });
  const showFocused = element => {
    const lines = tooltipTexts.get(element);
    if (!lines) return hideTooltip();
    const box = element.getBoundingClientRect();
    showTooltip(lines, box.left + box.width / 2, box.top + box.height / 2);
  };
  document.addEventListener('focusin', event => showFocused(event.target));
  document.addEventListener('keydown', event => {
    if (event.key === 'Escape') hideTooltip();
  });
  // The page also scrolls to show a mark that gets the focus.
  addEventListener('scroll', () => {
    if (!tooltip.hidden) showFocused(document.activeElement);
  }, {passive: true});
}
