// Questions to the server of the live page (sw/python/README.md).

// Why a board is refused: problems with place, key, value, rule and message.
export class Refused extends Error {
  constructor(problems) {
    super(problems.map(({place, message}) => message.includes(' ') ? message : `${place}: ${message}`)
              .join('\n'));
    this.problems = problems;
  }
}

async function checked(response) {
  if (response.ok) return response;
  const text = await response.text();
  let error = text || `The server answers ${response.status}.`;
  try {
    ({error} = JSON.parse(text));
  } catch {
    // a plain text
  }
  throw new Error(error);
}

async function documentOf(response) {
  const answer = await response.json();
  if (answer.problems?.length) throw new Refused(answer.problems);
  return answer;
}

async function send(path, method, type, body, signal) {
  let response;
  try {
    response = await fetch(path, {method, body, signal, headers: {'Content-Type': type}});
  } catch (error) {
    if (error.name === 'AbortError') throw error;
    throw new Error('The server does not answer. Has it ended? Start `stereotlm serve` again.');
  }
  return checked(response);
}

const post = (path, body, signal) => send(path, 'POST', 'application/json', JSON.stringify(body), signal);

const bodyOf = ({preset, sets, calibration}, more = {}) =>
    ({board: preset, sets, ...calibration ? {calibration} : {}, ...more});

export const ask = async (path, board, more, signal) =>
    documentOf(await post(path, bodyOf(board, more), signal));

export const sendPicture = async file =>
    (await documentOf(await send('picture', 'PUT', 'application/octet-stream', file))).id;

export const boardOfFile = async text => documentOf(await post('check', {yaml: text}));
export const boardFiles = async () => (await documentOf(await checked(await fetch('boards')))).files;

// A long question: `progress(done, of, text)` is called until its document is there.
export async function askLong(path, board, more, signal, progress) {
  const response = await post(path, bodyOf(board, more), signal);
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  for (let text = '';;) {
    const {done, value} = await reader.read();
    text += value ?? '';
    const lines = text.split('\n');
    text = lines.pop();
    for (const line of lines) {
      const said = JSON.parse(line);
      if (said.document) return said.document;
      if (said.problems) throw new Refused(said.problems);
      if (said.error) throw new Error(said.error);
      progress(said.done, said.of, said.text);
    }
    if (done) throw new Error('The server has ended its answer too early.');
  }
}

const kPatience = 400;  // ms, after which a question is given up for a newer one

// Asks one question after the other: while one is open, only the newest of the others waits.
export function inTurn(question, answered, failed) {
  let next = null;
  let open = null;  // the controller of the open question
  let since = 0;
  const begin = async () => {
    const asked = next;
    next = null;
    open = new AbortController();
    since = performance.now();
    let answer = null;
    try {
      answer = await question(asked, open.signal);
    } catch (error) {
      if (error.name !== 'AbortError') failed(asked, error);
    }
    open = null;
    if (next) begin();
    if (answer) answered(asked, answer);
  };
  return board => {
    next = board;
    if (!open) return begin();
    const controller = open;
    setTimeout(() => next && controller.abort(), Math.max(0, kPatience - (performance.now() - since)));
  };
}
