// Elements of HTML and SVG. Text always becomes a text node, so that nothing in the data can run.

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes ?? {})) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === 'function')
      element.addEventListener(name, value);
    else
      element.setAttribute(name, value === true ? '' : value);
  }
  for (const child of children.flat(Infinity)) {
    if (child !== null && child !== undefined && child !== false) element.append(child);
  }
  return element;
}

// h('button', {class: 'x', click: handler}, 'text', child)
export const h = (tag, attributes, ...children) => fill(document.createElement(tag), attributes, children);
export const s = (tag, attributes, ...children) =>
    fill(document.createElementNS('http://www.w3.org/2000/svg', tag), attributes, children);

export const button = (label, click, attributes) =>
    h('button', {type: 'button', class: 'small', click, ...attributes}, label);

// A list from which one is chosen. options: [[value, text], ..]
export const choice = (id, options, chosen, change) =>
    h('select', {id, change: event => change(event.target.value)},
      options.map(([value, text]) => h('option', {value, selected: value === chosen}, text)));

export const checkBox = (id, label, change) =>
    h('label', {class: 'check'},
      h('input', {type: 'checkbox', id, change: event => change(event.target.checked)}), ` ${label}`);

export const controls = (...children) => h('div', {class: 'controls'}, children);
export const note = text => text && h('p', {class: 'note'}, text);
export const folded = (title, ...children) => h('details', null, h('summary', null, title), children);

export function download(name, type, text) {
  const url = URL.createObjectURL(new Blob([text], {type}));
  const link = h('a', {href: url, download: name});
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

// A button that copies a text. Where the clipboard is closed to the page, the text is selected instead.
function copyButton(text, shown) {
  const copy = button('Copy', async () => {
    try {
      await navigator.clipboard.writeText(text);
      copy.textContent = 'Copied';
    } catch {
      getSelection().selectAllChildren(shown);
      copy.textContent = 'Selected: Ctrl-C';
    }
    setTimeout(() => copy.replaceChildren('Copy'), 1500);
  });
  return copy;
}

// A text with buttons that copy and download it.
export function textBox(text, name) {
  const shown = h('pre', {tabindex: '0'}, text);
  const save = button('Download', () => download(name, 'text/yaml', text));
  return h('div', {class: 'text'}, controls(copyButton(text, shown), save), shown);
}

export function commandLine(command) {
  const shown = h('code', null, command);
  return h('div', {class: 'command'}, shown, copyButton(command, shown));
}

// A file name from any text.
export const fileName = text => text.replace(/[^A-Za-z0-9._-]+/g, '_').slice(0, 80) || 'report';
