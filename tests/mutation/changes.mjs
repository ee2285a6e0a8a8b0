// Which wrong changes a source may suffer: one operator or one constant, as a tired hand makes them. Code is formatted,
// so an operator of two sides stands between spaces, and what does not is a template, a reference or a sign.
const swaps = [[" < ", " <= "], [" <= ", " < "], [" > ", " >= "], [" >= ", " > "], [" == ", " != "], [" != ", " == "],
  [" && ", " || "], [" || ", " && "], [" + ", " - "], [" - ", " + "], [" * ", " / "], [" / ", " * "],
  [" += ", " -= "], [" -= ", " += "], ["std::min(", "std::max("], ["std::max(", "std::min("],
  ["true", "false"], ["false", "true"], ["++", "--"]];

/// The line without what is no code: texts and a comment are blanks of the same length.
function code(line) {
  return line.replace(/"(\\.|[^"\\])*"|'(\\.|[^'\\])'/g, (text) => " ".repeat(text.length))
    .replace(/\/\/.*/, (text) => " ".repeat(text.length));
}

const isWord = (c) => c !== undefined && /[A-Za-z0-9_]/.test(c);

/// [{line (from 0), was, is, text: the whole line then}] of each change that is possible.
export function changesOf(source) {
  const found = [];
  let inComment = false;
  source.split("\n").forEach((whole, line) => {
    const text = code(whole);
    if (inComment) { inComment = !text.includes("*/"); return; }
    if (text.includes("/*")) { inComment = !text.includes("*/"); return; }
    if (/^\s*(#|using |namespace |template|static_assert|})/.test(text)) return;
    const add = (at, was, is) =>
      found.push({ line, was: was.trim(), is: is.trim(), text: whole.slice(0, at) + is + whole.slice(at + was.length) });
    for (const [was, is] of swaps)
      for (let at = text.indexOf(was); at >= 0; at = text.indexOf(was, at + 1))
        if (!/\w/.test(was[0]) || (!isWord(text[at - 1]) && !(was.at(-1) !== "(" && isWord(text[at + was.length])))) add(at, was, is);
    for (const { 0: number, index: at } of text.matchAll(/\d+(\.\d+)?(e-?\d+)?/g)) {
      // Not of a name, a template's argument, a fixed-width type or a hexadecimal number.
      if (isWord(text[at - 1]) || isWord(text[at + number.length]) || text[at - 1] === "." || text[at - 1] === "<") continue;
      add(at, number, number === "0" ? "1" : number === "1" ? "2" : /[.e]/.test(number) ? `${1.5 * Number(number)}` : `${Number(number) + 1}`);
    }
  });
  return found;
}
