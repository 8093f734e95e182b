// Reads "SWV1" messages (docs/view-protocol.md) and the packed numbers in them. Knows neither WebGL nor the server.

// Reads a message of `buffer` (ArrayBuffer): {header, columns: [{column, ranges, bytes}]}; `bytes` are views into `buffer`.
export function readMessage(buffer) {
  const view = new DataView(buffer);
  if (buffer.byteLength < 8 || view.getUint32(0, false) !== 0x53575631) throw new Error('not an SWV1 message');
  const length = view.getUint32(4, true);
  const start = 8 + length;
  if (start > buffer.byteLength) throw new Error('an SWV1 message ends within its header');
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, length)));
  const columns = header.parts.map(({ column, ranges, offset, bytes }) => {
    if (start + offset + bytes > buffer.byteLength) throw new Error(`an SWV1 message ends within ${column}`);
    return { column, ranges, bytes: new Uint8Array(buffer, start + offset, bytes) };
  });
  return { header, columns };
}

// float32 of every float16, by its bits.
const HALVES = (() => {
  const table = new Float32Array(65536);
  for (let bits = 0; bits < 65536; bits++) {
    const exponent = (bits >> 10) & 31;
    const fraction = bits & 1023;
    const size =
      exponent === 0 ? fraction * 2 ** -24
      : exponent === 31 ? (fraction ? NaN : Infinity)
      : (1 + fraction / 1024) * 2 ** (exponent - 15);
    table[bits] = bits & 0x8000 ? -size : size;
  }
  return table;
})();

export const half = (bits) => HALVES[bits];
