"use strict";
// Deflated data (RFC 1951) unpacked at once: the browser's own way to do that would make the page wait for it.

// Canonical Huffman codes of some lengths as a table by the next bits: 16 times the symbol plus the length of its code.
function huffman(lengths) {
  const most = Math.max(...lengths, 1), table = new Uint32Array(1 << most), count = new Uint16Array(17), next = new Uint16Array(17);
  for (const n of lengths) count[n]++;
  count[0] = 0;
  for (let n = 1, code = 0; n <= most; n++) next[n] = code = (code + count[n - 1]) << 1;
  lengths.forEach((n, symbol) => {
    if (!n) return;
    let code = next[n]++, turned = 0;
    for (let k = 0; k < n; k++, code >>= 1) turned = (turned << 1) | (code & 1); // codes come with their first bit first
    for (let at = turned; at < table.length; at += 1 << n) table[at] = (symbol << 4) | n;
  });
  return { table, most };
}

// text: bytes as characters. Returns a Uint8Array.
function inflate(text) {
  const input = new Uint8Array(text.length + 8);
  for (let i = 0; i < text.length; i++) input[i] = text.charCodeAt(i);
  let output = new Uint8Array(4 * text.length + 1024), length = 0, at = 0, held = 0, count = 0;
  const room = (more) => {
    if (length + more <= output.length) return;
    const larger = new Uint8Array(2 * output.length + more);
    larger.set(output.subarray(0, length));
    output = larger;
  };
  const fill = () => { while (count <= 16) { held |= input[at++] << count; count += 8; } };
  const bits = (n) => {
    fill();
    const value = held & ((1 << n) - 1);
    held >>>= n;
    count -= n;
    return value;
  };
  const symbol = (code) => {
    fill();
    const found = code.table[held & ((1 << code.most) - 1)];
    held >>>= found & 15;
    count -= found & 15;
    return found >> 4;
  };
  const lengths = (code, total) => { // run by run
    const result = [];
    while (result.length < total) {
      const s = symbol(code);
      if (s < 16) result.push(s);
      else {
        const value = s === 16 ? result.at(-1) : 0;
        for (let n = s === 16 ? 3 + bits(2) : s === 17 ? 3 + bits(3) : 11 + bits(7); n > 0; n--) result.push(value);
      }
    }
    return result;
  };
  const least = (first, extra) => { // least length (distance) of each symbol
    const base = [first];
    extra.forEach((n) => base.push(base.at(-1) + (1 << n)));
    return base;
  };
  const EXTRA = Array.from({ length: 28 }, (_, i) => Math.max(0, (i >> 2) - 1)), FAR = Array.from({ length: 30 }, (_, i) => Math.max(0, (i >> 1) - 1));
  const LEAST = least(3, EXTRA), NEAREST = least(1, FAR);
  EXTRA.push(0);
  LEAST[28] = 258;
  const block = (literal, distance) => {
    for (;;) {
      const s = symbol(literal);
      if (s === 256) return;
      if (s < 256) {
        if (length === output.length) room(1);
        output[length++] = s;
        continue;
      }
      const size = LEAST[s - 257] + bits(EXTRA[s - 257]), d = symbol(distance), back = NEAREST[d] + bits(FAR[d]);
      room(size);
      for (let i = 0; i < size; i++, length++) output[length] = output[length - back];
    }
  };
  for (let last = 0; !last;) {
    last = bits(1);
    const kind = bits(2);
    if (kind === 0) {
      at -= count >> 3; // whole bytes that were taken ahead
      held = count = 0;
      const size = input[at] | (input[at + 1] << 8);
      room(size);
      output.set(input.subarray(at + 4, at + 4 + size), length);
      length += size;
      at += 4 + size;
    } else if (kind === 1) {
      block(huffman([...Array(144).fill(8), ...Array(112).fill(9), ...Array(24).fill(7), ...Array(8).fill(8)]), huffman(Array(30).fill(5)));
    } else {
      const [n, m, k] = [257 + bits(5), 1 + bits(5), 4 + bits(4)], own = Array(19).fill(0);
      [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15].slice(0, k).forEach((s) => { own[s] = bits(3); });
      const all = lengths(huffman(own), n + m);
      block(huffman(all.slice(0, n)), huffman(all.slice(n)));
    }
  }
  return output.subarray(0, length);
}
