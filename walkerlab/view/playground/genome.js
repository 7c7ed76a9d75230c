// Genomes: their text form, their limits, and the robot that they express. `page` is the data of payload.py.

function expressRobot(page, values) { // the same as express in genome/phenotype.py
  const body = (name) => values[page.body_features.indexOf(name)];
  const segments = [];
  let legs = null;
  for (let number = 0; number < Math.round(body("segments")); number++) {
    const gene = (name) => values[geneIndex(page, name, number)];
    if (gene("legs") > 0 && !(legs && gene("repeat") > 0)) {
      legs = {
        length: gene("leg_length"), force: gene("leg_force"), phase: gene("hip_phase"), stride: gene("stride"), source: number,
        hip: { amplitude: gene("hip_amplitude"), phase: 0, offset: gene("hip_offset") },
        knee: { amplitude: gene("knee_amplitude"), phase: gene("knee_phase"), offset: gene("knee_offset") },
      };
    }
    const shifted = gene("legs") > 0 ? { ...legs, phase: legs.phase - number * body("lag") } : null;
    segments.push({ length: gene("length"), mass: gene("mass"), legs: shifted });
  }
  return { segments, frequency: body("frequency"), duty: body("duty"), body_length: py.sum(segments.map(({ length }) => length)) };
}

function geneIndex(page, name, segment = 0) {
  const index = page.body_features.indexOf(name);
  return index >= 0 ? index
    : page.body_features.length + segment * page.segment_features.length + page.segment_features.indexOf(name);
}

const countSegments = (page, values) => (values.length - page.body_features.length) / page.segment_features.length;

// Returns a genome with as many segments as the settings allow: the last one is copied, or the last ones are dropped, as by Genome.within.
function fitSegments(page, values) {
  const nBody = page.body_features.length, size = page.segment_features.length, count = countSegments(page, values);
  const segment = (number) => values.slice(nBody + size * number, nBody + size * (number + 1));
  return [...values.slice(0, nBody), ...py.range(page.n_segments).flatMap((number) => segment(Math.min(number, count - 1)))];
}

const bodyPlan = (robot) => robot.segments.map(({ legs }) => (legs ? 1 : 0)).join("");

// ------------------------------------------------------------------------------------------------------------ limits

// Returns the name of the limit that a genome violates, or "". A genome within all limits is not changed by repair.
function violatedLimit(page, values) {
  const robot = expressRobot(page, values);
  const limits = page.limits;
  const tolerance = 1e-9;
  const isOutside = (value, [low, high]) => value < low - tolerance || value > high + tolerance;
  const count = robot.segments.length;
  if (isOutside(count, limits.segments)) return `${limits.segments.join(" to ")} segments`;
  const pairs = robot.segments.filter(({ legs }) => legs).length;
  if (isOutside(pairs, limits.leg_pairs)) return `${limits.leg_pairs.map((n) => 2 * n).join(" to ")} legs`;
  if (isOutside(robot.body_length, limits.body_length[count - 1])) {
    return `a body length of ${limits.body_length[count - 1].map((value) => +value.toFixed(2)).join(" to ")} m`;
  }
  const weight = py.sum(robot.segments.map(({ mass }) => mass));
  if (isOutside(weight, limits.weight)) return `a weight of ${limits.weight.join(" to ")} kg`;
  for (const { length, mass, legs } of robot.segments) {
    const { min_trunk, max_trunk, min_legs, max_legs } = limits.mass_per_cube;
    const cubes = [length ** 3, legs ? legs.length ** 3 : 0];
    const low = Math.ceil((min_trunk * cubes[0] + min_legs * cubes[1]) * 1000 - 1e-9) / 1000;
    const high = Math.floor((max_trunk * cubes[0] + max_legs * cubes[1]) * 1000 + 1e-9) / 1000;
    if (isOutside(mass, [low, high])) return `a mass of ${low} to ${high} kg for a segment of this length with its legs`;
  }
  return "";
}

// Returns the value closest to the wanted one with which the genome is within all limits, rounded as by repair.
function nearestAllowed(page, values, index, wanted) {
  const allows = (value) => !violatedLimit(page, values.with(index, value));
  const onGrid = (value) => Math.round(value * 1000) / 1000;
  if (allows(onGrid(wanted))) return onGrid(wanted);
  let near = values[index], far = wanted;
  for (let i = 0; i < 30; i++) {
    const middle = (near + far) / 2;
    if (allows(middle)) near = middle; else far = middle;
  }
  const inward = [Math.floor(near * 1000) / 1000, Math.ceil(near * 1000) / 1000].filter(allows);
  return inward.length ? inward.sort((a, b) => Math.abs(a - wanted) - Math.abs(b - wanted))[0] : values[index];
}

// --------------------------------------------------------------------------------------------------------------- text

function formatGenome(page, values) { // the same as format_text in genome/text.py
  return page.layouts[countSegments(page, values) - 1].map(([token, index]) => {
    if (index === null) return token;
    const words = page.choices[token];
    if (!words) return `${token}${values[index]}`;
    return words[values[index]] ?? `${token}=${values[index]}`;
  }).join(" ");
}

class GenomeError extends Error {}

// Returns the gene values in a text; error messages are those of parse_text in genome/text.py.
function parseGenome(page, text) {
  const length = [...text].length; // Python counts code points
  if (length > page.max_text_length) {
    throw new GenomeError(`a genome's text has at most ${page.max_text_length} characters; this one has ${length}`);
  }
  const space = "[\\s\\x1c-\\x1f\\x85]";
  const words = [...text.replaceAll("\ufeff", "\ufffc").matchAll(new RegExp(`\\||(?:(?!${space}|\\|)[^])+`, "gu"))]
    .map((match) => ({ word: text.slice(match.index, match.index + match[0].length), start: match.index }));
  const counted = words.filter(({ word }) => word === "seg").length;
  const n = Math.min(Math.max(counted, 1), page.layouts.length);
  const isVersion1 = new RegExp(`^${space}*wl1`, "u").test(text);
  const layout = (isVersion1 ? page.layouts_1 : page.layouts)[n - 1];
  const values = [...page.initial_values.body, ...Array(n).fill(page.initial_values.segment).flat()];
  const end = text.replace(new RegExp(`${space}+$`, "u"), "").length;
  layout.forEach(([token, index], position) => {
    const { word, start } = words[position] ?? { word: "the end of the text", start: end };
    if (index === null) {
      if (word === token) return;
      const condition = token === "gait" && word === "seg" ? ` after at most ${page.layouts.length} segments` : "";
      throw positionError(page, text, start, `'${token}'${condition}`, word);
    }
    const choices = page.choices[token];
    if (choices?.includes(word)) { values[index] = choices.indexOf(word); return; }
    const key = choices ? `${token}=` : token;
    const number = word.startsWith(key) ? word.slice(key.length) : "";
    if (!/^[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]{1,3})?$/.test(number)) {
      const expected = choices ? [...choices].reverse().map((choice) => `'${choice}'`).join(" or ")
        : `'${token}' and a number, as in '${token}0.5'`;
      throw positionError(page, text, start, expected, word);
    }
    values[index] = Number(number) + 0;
    if (!Number.isFinite(values[index])) throw positionError(page, text, start, `'${token}' and a finite number`, word);
  });
  if (words.length > layout.length) {
    const { word, start } = words[layout.length];
    throw positionError(page, text, start, "the end of the text", word);
  }
  return values;
}

function positionError(page, text, start, expected, got) {
  const letters = [...text];
  const position = [...text.slice(0, start)].length;
  const before = Math.min(position, page.error_context);
  const shown = letters.slice(position - before, position + page.error_context).map((letter) =>
    /[\s\x1c-\x1f\x85]/u.test(letter) && letter !== "\ufeff" ? " " : isPrintable(letter) ? letter : "�").join("");
  return new GenomeError(`not a genome: at character ${position + 1} expected ${expected}, got ${shortRepr(page, got)}\n` +
    `    ${shown}\n    ${" ".repeat(before)}^`);
}

const isPrintable = (letter) => letter === " " || !/[\p{C}\p{Z}]/u.test(letter);

// The same as short_repr in settings/values.py, for strings.
function shortRepr(page, text) {
  const limit = page.max_text - 10;
  const represent = (letters) => {
    const quote = letters.includes("'") && !letters.includes('"') ? '"' : "'";
    const escaped = letters.map((letter) => {
      if (letter === quote || letter === "\\") return `\\${letter}`;
      if (isPrintable(letter)) return letter;
      const named = { "\n": "\\n", "\r": "\\r", "\t": "\\t" }[letter];
      const code = letter.codePointAt(0);
      const [prefix, digits] = code < 0x100 ? ["\\x", 2] : code < 0x10000 ? ["\\u", 4] : ["\\U", 8];
      return named ?? prefix + code.toString(16).padStart(digits, "0");
    });
    return [...`${quote}${escaped.join("")}${quote}`];
  };
  const letters = [...text];
  let shown = represent(letters.slice(0, limit));
  if (shown.length > limit) { // as reprlib.Repr.repr_str
    const i = Math.max(0, Math.floor((limit - 3) / 2));
    const j = Math.max(0, limit - 3 - i);
    shown = represent([...letters.slice(0, i), ...letters.slice(letters.length - j)]);
    shown = [...shown.slice(0, i), ..."...", ...shown.slice(shown.length - j)];
  }
  return shown.length <= page.max_text ? shown.join("") : `${shown.slice(0, page.max_text - 1).join("")}…`;
}
