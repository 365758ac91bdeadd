// What skein.wasm asks of its surroundings, as WASI names it: a clock, and a log for what the C library writes. There are
// no files (a scene's come by js_file_add) and no arguments.

const BAD_HANDLE = 8, NO_ENTRY = 44, NO_SPACE = 28;

// `memory()` gives the module's memory as it is now; `log` gets whole lines; `environment` has names and values.
export function wasi(memory, log, environment = {}) {
    const view = () => new DataView(memory().buffer);
    const variables = Object.entries(environment).map(([name, value]) => new TextEncoder().encode(`${name}=${value}\0`));
    const decoder = new TextDecoder();
    let line = '';

    function write(handle, list, count, written) {
        if (handle !== 1 && handle !== 2) return BAD_HANDLE;
        let size = 0;
        for (let i = 0; i < count; i++) {
            const at = view().getUint32(list + 8 * i, true), length = view().getUint32(list + 8 * i + 4, true);
            line += decoder.decode(new Uint8Array(memory().buffer, at, length).slice(), {stream: true});
            size += length;
        }
        const lines = line.split('\n');
        line = lines.pop();
        for (const whole of lines) log(whole);
        view().setUint32(written, size, true);
        return 0;
    }

    return {
        environ_sizes_get(count, size) {
            view().setUint32(count, variables.length, true);
            view().setUint32(size, variables.reduce((sum, {length}) => sum + length, 0), true);
            return 0;
        },
        environ_get(list, at) {
            variables.forEach((bytes, i) => {
                view().setUint32(list + 4 * i, at, true);
                new Uint8Array(memory().buffer).set(bytes, at);
                at += bytes.length;
            });
            return 0;
        },
        clock_time_get(clock, precision, out) {
            const ms = clock === 0 ? Date.now() : performance.now();
            view().setBigUint64(out, BigInt(Math.round(ms * 1e6)), true);
            return 0;
        },
        fd_write: write,
        fd_prestat_get: () => BAD_HANDLE, // no folder is open
        fd_prestat_dir_name: () => BAD_HANDLE,
        fd_fdstat_get: () => BAD_HANDLE,
        fd_fdstat_set_flags: () => BAD_HANDLE,
        fd_close: () => BAD_HANDLE,
        fd_read: () => BAD_HANDLE,
        fd_seek: () => BAD_HANDLE,
        path_filestat_get: () => NO_ENTRY,
        path_open: () => NO_ENTRY,
        random_get(at, size) {
            if (size > 65536) return NO_SPACE;
            new Uint8Array(memory().buffer, at, size).set(crypto.getRandomValues(new Uint8Array(size))); // (into no shared memory)
            return 0;
        },
        proc_exit(status) {
            throw new Error(`skein.wasm ended with status ${status}`);
        },
    };
}
