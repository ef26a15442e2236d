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

export function download(name, type, text) {
  const url = URL.createObjectURL(new Blob([text], {type}));
  const link = h('a', {href: url, download: name});
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

// A button that copies a text. Where the clipboard is closed to the page, the text is selected instead.
export function copyButton(label, text, shown) {
  const button = h('button', {type: 'button', class: 'small'}, label);
  button.addEventListener('click', async () => {
    try {
      await navigator.clipboard.writeText(text());
      button.textContent = 'Copied';
    } catch {
      getSelection().selectAllChildren(shown);
      button.textContent = 'Selected: Ctrl-C';
    }
    setTimeout(() => {
      button.textContent = label;
    }, 1500);
  });
  return button;
}

// A file name from any text.
export const fileName = text => text.replace(/[^A-Za-z0-9._-]+/g, '_').slice(0, 80) || 'report';
