// SPDX-License-Identifier: Apache-2.0
// One quad per pixel for the visible points of the unit sphere, and an encoder of pixels as text.
//
// The quads lie in the plane of the picture. The four corners of a quad have the sphere's normal at
// the pixel's center, so interpolation does not change the normal.

export function sphere(size) {
    const positions = [], normals = [], tangents = [], indices = [];
    for (let row = 0; row < size; ++row) {
        for (let column = 0; column < size; ++column) {
            const x = (2 * column + 1) / size - 1, y = 1 - (2 * row + 1) / size;
            if (x * x + y * y >= 1) continue;
            const normal = [x, y, Math.sqrt(1 - x * x - y * y)], half = 1 / size;
            const across = Math.hypot(normal[0], normal[2]); // tangents point eastward
            const tangent = [normal[2] / across, 0, -normal[0] / across, 1];
            const first = positions.length / 3;
            for (const [dx, dy] of [[-half, -half], [half, -half], [half, half], [-half, half]]) {
                positions.push(x + dx, y + dy, 0);
                normals.push(...normal);
                tangents.push(...tangent);
            }
            indices.push(first, first + 1, first + 2, first, first + 2, first + 3);
        }
    }
    return {
        positions: new Float32Array(positions),
        normals: new Float32Array(normals),
        tangents: new Float32Array(tangents),
        indices: new Uint32Array(indices),
    };
}

// Encodes RGBA pixels as base64 of float32, top row first. `bottomUp` is the order of `pixels`.
export function encode(pixels, size, bottomUp) {
    const width = 4 * size;
    const rows = new Float32Array(width * size);
    for (let row = 0; row < size; ++row) {
        const from = bottomUp ? size - 1 - row : row;
        rows.set(pixels.subarray(from * width, (from + 1) * width), row * width);
    }
    const bytes = new Uint8Array(rows.buffer);
    let text = "";
    for (let start = 0; start < bytes.length; start += 32768) {
        text += String.fromCharCode(...bytes.subarray(start, start + 32768));
    }
    return btoa(text);
}
