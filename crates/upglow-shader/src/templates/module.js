function upglow_mix(a, b, t) {
    return a * (1 - t) + b * t;
}

// FNV-1a, 64 bits in hexadecimal. Its prime is 2^40 + 0x1b3.
function upglow_checksum(bytes) {
    let high = 0xcbf29ce4;
    let low = 0x84222325;
    for (let i = 0; i < bytes.length; i += 1) {
        const mixed = (low ^ bytes[i]) >>> 0;
        const product = mixed * 0x1b3;
        const carry = Math.floor(product / 2 ** 32);
        high = (Math.imul(high, 0x1b3) + (mixed << 8) + carry) | 0;
        low = product >>> 0;
    }
    return [high, low].map((half) => (half >>> 0).toString(16).padStart(8, "0")).join("");
}

// Throws an Error if this is not the content of the file that belongs to this text.
function upglow_check(textures) {
    const kind = Object.prototype.toString.call(textures).slice(8, -1);
    if (kind !== "ArrayBuffer") {
        throw new TypeError(`found ${kind}, expected ${UPGLOW_TEXTURES} as an ArrayBuffer`);
    }
    const bytes = new Uint8Array(textures);
    if (bytes.length < 64 || String.fromCharCode(...bytes.subarray(0, 8)) !== UPGLOW_MAGIC) {
        throw new Error(`${UPGLOW_TEXTURES}: expected a file that begins with ${UPGLOW_MAGIC}`);
    }
    const version = new DataView(textures).getUint32(8, true);
    if (version !== UPGLOW_VERSION) {
        throw new Error(`${UPGLOW_TEXTURES}: version ${version}, expected ${UPGLOW_VERSION}`);
    }
    if (bytes.length !== UPGLOW_BYTES) {
        throw new Error(`${UPGLOW_TEXTURES}: ${bytes.length} bytes, expected ${UPGLOW_BYTES}`);
    }
    const checksum = upglow_checksum(bytes.subarray(64));
    if (checksum !== UPGLOW_CHECKSUM) {
        throw new Error(
            `${UPGLOW_TEXTURES}: checksum ${checksum}, expected ${UPGLOW_CHECKSUM}: ` +
                "damaged, or of another cube; export both files again",
        );
    }
}

/**
 * The functions of the cube by their names, in double precision.
 *
 * @param {ArrayBuffer} textures - the content of the file that the head of this text names
 * @throws {Error} if it is the content of another file, or damaged
 */
