// The functions of Python that translated code uses; see translation.py.
const py = {
  list: (items) => [...items],
  len: (items) => items.length,
  enumerate: (items, start = 0) => [...items].map((item, number) => [number + start, item]),
  reversed: (items) => [...items].reverse(),
  zip: (...lists) => lists[0].map((_, number) => lists.map((list) => list[number])),
  range: (count) => Array.from({ length: count }, (_, number) => number),
  sum: (items) => items.reduce((total, item) => total + item, 0),
  min: (...items) => Math.min(...(items.length === 1 ? items[0] : items)),
  max: (...items) => Math.max(...(items.length === 1 ? items[0] : items)),
  item: (items, index) => items[index < 0 ? items.length + index : index],
  assign(owner, name, value) { // arrays of MuJoCo are views of its memory and cannot be replaced
    if (typeof owner[name] === "object" && owner[name] !== null) owner[name].set(value);
    else owner[name] = value;
  },
};
