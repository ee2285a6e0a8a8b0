// Where sources say what went wrong: calls of `fail` and `wrong_use` with words of their own.

/// The place behind what stands in quotes.
function behindQuote(text, at) {
  for (++at; at < text.length && text[at] !== '"'; ++at) if (text[at] === "\\") ++at;
  return at + 1;
}

/// Of a call whose arguments begin at `at`: the literals of the first one, with … between, and where the call ends.
function argumentsFrom(text, at) {
  const words = [];
  let first = true;
  for (let depth = 1; at < text.length; ++at) {
    const letter = text[at];
    if (letter === '"') {
      const end = behindQuote(text, at);
      if (first) words.push(text.slice(at + 1, end - 1));
      at = end - 1;
    } else if ("([{".includes(letter)) {
      ++depth;
    } else if (")]}".includes(letter) && --depth === 0) {
      break;
    } else if (letter === "," && depth === 1) {
      first = false;
    }
  }
  return { words: words.join("…"), end: at + 1 };
}

/// The messages of a source: their words, the line from 1, where the call begins and ends.
export function messagesOf(source) {
  const text = source.replace(/\/\/[^\n]*/g, (comment) => " ".repeat(comment.length));
  return [...text.matchAll(/(?<![\w.:>])(?:fail|wrong_use)\(/g)].map((call) => {
    const { words, end } = argumentsFrom(text, call.index + call[0].length);
    return { words, begin: call.index, end, line: text.slice(0, call.index).split("\n").length };
  }).filter(({ words }) => words);
}

/// The same source, which notes each message that it makes: number(i) for its message i.
export function noting(source, number) {
  let made = source;
  for (const [i, { begin, end }] of [...messagesOf(source).entries()].reverse())
    made = `${made.slice(0, begin)}::prehend::noted(${number(i)}, ${made.slice(begin, end)})${made.slice(end)}`;
  return made;
}
