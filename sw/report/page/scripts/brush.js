// Selecting a range of a plot with the pointer.
import {s} from './dom.js';

// Adds a brush to a plot of this size. axis: 'x', 'y' or 'xy'. `change(box)` is called while the pointer
// moves, `end(box)` when it is released: {x0, x1, y0, y1} in pixels, or null after a click, which
// clears the brush.
export function addBrush(plot, {axis, width, height, change, end}) {
  const area = s('rect', {x: 0, y: 0, width, height, class: `brush brush-${axis}`});
  const shown = s('rect', {class: 'brushed', visibility: 'hidden'});
  plot.append(area, shown);
  let from = null;
  const at = event => {
    const box = area.getBoundingClientRect();
    return {
      x: (event.clientX - box.left) / box.width * width,
      y: (event.clientY - box.top) / box.height * height
    };
  };
  const within = (value, most) => Math.max(0, Math.min(most, value));
  const show = box => {
    if (!box) return shown.setAttribute('visibility', 'hidden');
    for (const [name, value] of Object.entries(
             {x: box.x0, y: box.y0, width: box.x1 - box.x0, height: box.y1 - box.y0}))
      shown.setAttribute(name, value);
    shown.setAttribute('visibility', 'visible');
  };
  const boxTo = event => {
    const to = at(event);
    const far = (!axis.includes('x') || Math.abs(to.x - from.x) < 4) &&
        (!axis.includes('y') || Math.abs(to.y - from.y) < 4);
    if (far) return null;
    const [x0, x1] = axis.includes('x') ? [Math.min(from.x, to.x), Math.max(from.x, to.x)] : [0, width];
    const [y0, y1] = axis.includes('y') ? [Math.min(from.y, to.y), Math.max(from.y, to.y)] : [0, height];
    return {x0: within(x0, width), x1: within(x1, width), y0: within(y0, height), y1: within(y1, height)};
  };
  area.addEventListener('pointerdown', event => {
    if (event.button !== 0) return;
    from = at(event);
    area.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  area.addEventListener('pointermove', event => {
    if (!from) return;
    const box = boxTo(event);
    show(box);
    change?.(box);
  });
  area.addEventListener('pointerup', event => {
    if (!from) return;
    const box = boxTo(event);
    from = null;
    show(box);
    end?.(box, event);
  });
  area.addEventListener('pointercancel', () => {
    from = null;
  });
  return {area, show};
}
