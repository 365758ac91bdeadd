// One thread: a worker that has the module once more, over the memory that all share, and works when a world asks.
// skein.js starts it and says which seat and stack are its own; threads/threads.c is its other side.
import {wasi} from './wasi.js';

async function work({module, memory, seat, stack}, tell) {
    const imports = {env: {memory}, wasi_snapshot_preview1: wasi(() => memory, (line) => console.warn(`skein: ${line}`))};
    const {exports} = await WebAssembly.instantiate(module, imports); // (what is in memory already is left as it is)
    exports.__stack_pointer.value = stack;
    tell('here');
    exports.js_work(seat); // for good: who started this worker ends it
}

if (typeof WorkerGlobalScope !== 'undefined') onmessage = ({data}) => work(data, postMessage);
else {
    const threads = 'node:worker_threads'; // (a name that bundlers leave alone)
    const {parentPort} = await import(/* @vite-ignore */ threads);
    parentPort.once('message', (data) => work(data, (word) => parentPort.postMessage(word)));
}
