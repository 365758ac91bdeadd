// The page's side of the worker: each call is a promise, a state comes when there is one. Faults are thrown as an error
// whose `faults` are the package's.
export class Simulation {
    #worker = new Worker(new URL('./worker.js', import.meta.url), {type: 'module'});
    #asked = new Map();
    #last = 0;

    constructor({onState, onBroken}) {
        this.#worker.onmessage = ({data}) => {
            if (data.state) {
                onState(data.state);
                requestAnimationFrame(() => this.#worker.postMessage('taken'));
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
}

export const words = (faults) => faults.map((f) => (f.where ? `${f.where}: ` : '') + f.message).join('\n');
