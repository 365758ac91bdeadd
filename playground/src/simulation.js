// The page's side of the worker: each call is a promise, a state comes when there is one. Faults are thrown as an error
// whose `faults` are the package's.

import address from './worker.js?worker&url';

/* A worker, also where this page took Skein from another server: such a worker is begun by a line of this page's own. */
function begin() {
    const url = new URL(address, import.meta.url);
    if (url.origin === location.origin) return new Worker(url, {type: 'module'});
    const line = new Blob([`import ${JSON.stringify(url.href)};`], {type: 'text/javascript'});
    return new Worker(URL.createObjectURL(line), {type: 'module'});
}

export class Simulation {
    #worker = begin();
    #asked = new Map();
    #last = 0;

    constructor({onState, onBroken}) {
        this.#worker.onmessage = ({data}) => {
            if (data.state) {
                onState(data.state);
                const taken = () => this.#worker.postMessage('taken');
                if (document.hidden) setTimeout(taken, 100); // which draws no frames
                else requestAnimationFrame(taken);
            } else if (data.broken) onBroken(data.broken);
            else {
                const {resolve, reject} = this.#asked.get(data.id);
                this.#asked.delete(data.id);
                if (data.faults) reject(Object.assign(new Error(words(data.faults)), {faults: data.faults}));
                else resolve(data.value);
            }
        };
        this.#worker.onerror = (event) => onBroken([{where: '', message: `the worker ended: ${event.message ?? ''}`}]);
    }
    call(call, ...args) {
        const id = ++this.#last;
        return new Promise((resolve, reject) => {
            this.#asked.set(id, {resolve, reject});
            this.#worker.postMessage({id, call, args});
        });
    }
    end() {
        this.#worker.terminate();
    }
}

export const words = (faults) => faults.map((f) => (f.where ? `${f.where}: ` : '') + f.message).join('\n');
