// SPDX-License-Identifier: Apache-2.0
// System that the engine sees (WASI, preview 1): a clock, random bytes, two streams, and files in memory.

const ERRNO = { success: 0, badf: 8, exist: 20, inval: 28, isdir: 31, noent: 44, nosys: 52, notdir: 54, spipe: 70 };
const TYPE = { character: 2, directory: 3, regular: 4 };
const ROOT = 3; // the folder that is open from the start

/** Thrown where the program ends itself. */
export class Exit extends Error {
  constructor(code) {
    super(`exit ${code}`);
    this.code = code;
  }
}

class File {
  constructor(bytes = new Uint8Array(0)) {
    this.bytes = bytes; // the first `size` of them count
    this.size = bytes.length;
  }
  resize(size) {
    if (size > this.bytes.length) {
      const bytes = new Uint8Array(Math.max(size, 2 * this.bytes.length));
      bytes.set(this.bytes.subarray(0, this.size));
      this.bytes = bytes;
    }
    if (size > this.size) this.bytes.fill(0, this.size, size);
    this.size = size;
  }
  content() {
    return this.bytes.slice(0, this.size);
  }
}

/** A path without its first slashes, dots and empty parts; undefined above the root. */
function normal(path) {
  const parts = [];
  for (const part of path.split("/")) {
    if (part === "..") {
      if (parts.length === 0) return undefined;
      parts.pop();
    } else if (part !== "" && part !== ".") parts.push(part);
  }
  return parts.join("/");
}

/** args: the program's words. files: name to bytes, in the one folder. write(stream, bytes): 1 is output, 2 errors. */
export class System {
  constructor({ args, files = {}, write = () => {} }) {
    this.args = args;
    this.write = write;
    this.files = new Map();
    for (const [name, bytes] of Object.entries(files)) this.put(name, bytes);
    this.folders = new Set(["", "tmp"]);
    this.open = new Map([
      [0, { type: TYPE.character }],
      [1, { type: TYPE.character }],
      [2, { type: TYPE.character }],
      [ROOT, { type: TYPE.directory, path: "" }],
    ]);
    this.memory = undefined; // of the instance, once there is one
  }

  put(name, bytes) {
    this.files.set(normal(name), new File(bytes.slice())); // the program may write to it
  }
  remove(name) {
    this.files.delete(normal(name));
  }
  /** Name to bytes, of all files that are there now. */
  contents() {
    return Object.fromEntries([...this.files].map(([name, file]) => [name, file.content()]));
  }

  get view() {
    return new DataView(this.memory.buffer);
  }
  bytes(pointer, length) {
    return new Uint8Array(this.memory.buffer, pointer, length);
  }
  text(pointer, length) {
    return new TextDecoder().decode(this.bytes(pointer, length));
  }
  path(descriptor, pointer, length) {
    const folder = this.open.get(descriptor);
    return folder?.type === TYPE.directory ? normal(`${folder.path}/${this.text(pointer, length)}`) : undefined;
  }

  /** The parts that a vector of buffers lists. */
  buffers(pointer, count) {
    const view = this.view;
    return Array.from({ length: count }, (_, k) =>
      this.bytes(view.getUint32(pointer + 8 * k, true), view.getUint32(pointer + 8 * k + 4, true)));
  }

  strings(words, pointers, buffer) {
    for (const word of words) {
      const bytes = new TextEncoder().encode(`${word}\0`);
      this.view.setUint32(pointers, buffer, true);
      this.bytes(buffer, bytes.length).set(bytes);
      pointers += 4;
      buffer += bytes.length;
    }
    return ERRNO.success;
  }

  stat(pointer, type, size) {
    this.bytes(pointer, 64).fill(0);
    this.view.setUint8(pointer + 16, type);
    this.view.setBigUint64(pointer + 24, 1n, true);
    this.view.setBigUint64(pointer + 32, BigInt(size), true);
    return ERRNO.success;
  }

  /** The regular file of a descriptor, for what only those can do. */
  regular(descriptor, use) {
    const entry = this.open.get(descriptor);
    if (entry === undefined) return ERRNO.badf;
    return entry.type === TYPE.regular ? use(entry) : ERRNO.spipe;
  }

  read_at(entry, buffers, at) {
    const begin = at;
    for (const buffer of buffers) {
      const count = Math.max(0, Math.min(buffer.length, entry.file.size - at));
      buffer.set(entry.file.bytes.subarray(at, at + count));
      at += count;
    }
    return at - begin;
  }

  write_at(entry, buffers, at) {
    const begin = at;
    for (const buffer of buffers) {
      if (at + buffer.length > entry.file.size) entry.file.resize(at + buffer.length);
      entry.file.bytes.set(buffer, at);
      at += buffer.length;
    }
    return at - begin;
  }

  /** The functions that the engine imports as wasi_snapshot_preview1. */
  imports() {
    const done = ERRNO.success;
    const put = (pointer, value) => {
      this.view.setUint32(pointer, value, true);
      return done;
    };
    const put64 = (pointer, value) => {
      this.view.setBigUint64(pointer, BigInt(value), true);
      return done;
    };
    const total = (words) => words.reduce((sum, word) => sum + new TextEncoder().encode(word).length + 1, 0);
    const known = {
      args_sizes_get: (count, size) => put(count, this.args.length) || put(size, total(this.args)),
      args_get: (pointers, buffer) => this.strings(this.args, pointers, buffer),
      environ_sizes_get: (count, size) => put(count, 0) || put(size, 0),
      environ_get: () => done,
      proc_exit: (code) => {
        throw new Exit(code);
      },
      sched_yield: () => done,
      clock_res_get: (_clock, pointer) => put64(pointer, 1000),
      clock_time_get: (clock, _precision, pointer) =>
        put64(pointer, Math.round((clock === 0 ? Date.now() : performance.now()) * 1e6)),
      random_get: (pointer, length) => {
        for (let at = 0; at < length; at += 65536)
          crypto.getRandomValues(this.bytes(pointer + at, Math.min(65536, length - at)));
        return done;
      },
      fd_prestat_get: (fd, pointer) => (fd === ROOT ? put(pointer, 0) || put(pointer + 4, 1) : ERRNO.badf),
      fd_prestat_dir_name: (fd, pointer) => {
        if (fd !== ROOT) return ERRNO.badf;
        this.view.setUint8(pointer, "/".charCodeAt(0));
        return done;
      },
      fd_close: (fd) => (this.open.delete(fd) ? done : ERRNO.badf),
      fd_sync: () => done,
      fd_datasync: () => done,
      fd_fdstat_get: (fd, pointer) => {
        const entry = this.open.get(fd);
        if (entry === undefined) return ERRNO.badf;
        this.bytes(pointer, 24).fill(0);
        this.view.setUint8(pointer, entry.type);
        // All rights, but for streams that to seek in and to tell where: by these a stream is told from a file.
        const rights = entry.type === TYPE.character ? ~(4n | 32n) : ~0n;
        this.view.setBigInt64(pointer + 8, rights, true);
        this.view.setBigInt64(pointer + 16, rights, true);
        return done;
      },
      fd_fdstat_set_flags: () => done,
      fd_filestat_get: (fd, pointer) => {
        const entry = this.open.get(fd);
        return entry === undefined ? ERRNO.badf : this.stat(pointer, entry.type, entry.file?.size ?? 0);
      },
      fd_filestat_set_size: (fd, size) =>
        this.regular(fd, (entry) => {
          entry.file.resize(Number(size));
          return done;
        }),
      fd_seek: (fd, offset, whence, pointer) =>
        this.regular(fd, (entry) => {
          const at = Number(offset) + [0, entry.at, entry.file.size][whence];
          if (at < 0) return ERRNO.inval;
          entry.at = at;
          return put64(pointer, at);
        }),
      fd_tell: (fd, pointer) => this.regular(fd, (entry) => put64(pointer, entry.at)),
      fd_read: (fd, vector, count, pointer) => {
        if (fd === 0) return put(pointer, 0);
        return this.regular(fd, (entry) => {
          const length = this.read_at(entry, this.buffers(vector, count), entry.at);
          entry.at += length;
          return put(pointer, length);
        });
      },
      fd_pread: (fd, vector, count, offset, pointer) =>
        this.regular(fd, (entry) => put(pointer, this.read_at(entry, this.buffers(vector, count), Number(offset)))),
      fd_write: (fd, vector, count, pointer) => {
        const buffers = this.buffers(vector, count);
        if (fd === 1 || fd === 2) {
          for (const buffer of buffers) if (buffer.length > 0) this.write(fd, buffer.slice());
          return put(pointer, buffers.reduce((sum, buffer) => sum + buffer.length, 0));
        }
        return this.regular(fd, (entry) => {
          const length = this.write_at(entry, buffers, entry.append ? entry.file.size : entry.at);
          entry.at = entry.append ? entry.file.size : entry.at + length;
          return put(pointer, length);
        });
      },
      fd_pwrite: (fd, vector, count, offset, pointer) =>
        this.regular(fd, (entry) => put(pointer, this.write_at(entry, this.buffers(vector, count), Number(offset)))),
      path_filestat_get: (fd, _flags, name, length, pointer) => {
        const path = this.path(fd, name, length);
        if (this.folders.has(path)) return this.stat(pointer, TYPE.directory, 0);
        const file = this.files.get(path);
        return file === undefined ? ERRNO.noent : this.stat(pointer, TYPE.regular, file.size);
      },
      path_open: (fd, _lookup, name, length, how, _rights, _inherited, flags, pointer) => {
        const path = this.path(fd, name, length);
        if (path === undefined) return ERRNO.noent;
        const create = how & 1, folder = how & 2, exclusive = how & 4, truncate = how & 8;
        let entry;
        if (this.folders.has(path)) {
          if (create) return ERRNO.isdir;
          entry = { type: TYPE.directory, path };
        } else {
          let file = this.files.get(path);
          if (file !== undefined && create && exclusive) return ERRNO.exist;
          if (file !== undefined && folder) return ERRNO.notdir;
          if (file === undefined) {
            if (!create || !this.folders.has(path.split("/").slice(0, -1).join("/"))) return ERRNO.noent;
            file = new File();
            this.files.set(path, file);
          }
          if (truncate) file.resize(0);
          entry = { type: TYPE.regular, file, at: 0, append: (flags & 1) !== 0 };
        }
        let free = ROOT + 1;
        while (this.open.has(free)) ++free;
        this.open.set(free, entry);
        return put(pointer, free);
      },
      // There are no links: EINVAL says so of what there is.
      path_readlink: (fd, name, length) => {
        const path = this.path(fd, name, length);
        return this.files.has(path) || this.folders.has(path) ? ERRNO.inval : ERRNO.noent;
      },
      path_unlink_file: (fd, name, length) => (this.files.delete(this.path(fd, name, length)) ? done : ERRNO.noent),
      path_rename: (fd, name, length, to_fd, to_name, to_length) => {
        const from = this.path(fd, name, length), to = this.path(to_fd, to_name, to_length);
        const file = this.files.get(from);
        if (file === undefined || to === undefined) return ERRNO.noent;
        this.files.delete(from);
        this.files.set(to, file);
        return done;
      },
    };
    // Addresses beyond 2 GB come as negative numbers.
    const unsigned = (word) => (typeof word === "number" ? word >>> 0 : word);
    return new Proxy(known, {
      get: (functions, name) => (...words) => functions[name]?.(...words.map(unsigned)) ?? ERRNO.nosys,
    });
  }
}
