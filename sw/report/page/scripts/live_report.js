// A page of `report` that the live page makes of its own text.

// The text of this page with other data, as a file that needs no server.
export async function reportOf(data) {
  const stream = new Blob([JSON.stringify(data)]).stream().pipeThrough(new CompressionStream('deflate'));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const letters = [];
  for (let at = 0; at < bytes.length; at += 0x8000)
    letters.push(String.fromCharCode(...bytes.subarray(at, at + 0x8000)));
  const style = document.querySelector('style').textContent;
  const script = document.querySelector('script[type=module]').textContent;
  return `<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n` +
      `<meta name="generator" content="stereotlm report">\n` +
      `<meta name="viewport" content="width=device-width, initial-scale=1">\n` +
      `<title>stereotlm report</title>\n` +
      `<link rel="icon" href="data:,">\n<style>\n${
             style}</style>\n</head>\n<body>\n<main id="page"></main>\n` +
      `<script type="text/plain" id="data">${btoa(letters.join(''))}</script>\n` +
      `<script type="module">\n${script}</script>\n</body>\n</html>\n`;
}
