// What undo comes back to: states with the events that led there. Each keeps only those events that the one before it
// has not, or what is kept would grow with the square of what was done.
const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

export class Past {
    #states = []; // {state, shared, events}: the first `shared` events are those of the state before
    #most;

    constructor(most = 100) {
        this.#most = most;
    }
    get length() {
        return this.#states.length;
    }
    /* Events that are kept, of all states together. */
    get kept() {
        return this.#states.reduce((sum, {events}) => sum + events.length, 0);
    }
    #eventsOf(index) {
        let all = [];
        for (const {shared, events} of this.#states.slice(0, index + 1)) all = [...all.slice(0, shared), ...events];
        return all;
    }
    push({events, ...state}) {
        const before = this.#eventsOf(this.length - 1);
        let shared = 0;
        while (shared < Math.min(before.length, events.length) && same(before[shared], events[shared])) shared++;
        this.#states.push({state, shared, events: events.slice(shared)});
        if (this.length <= this.#most) return;
        const second = this.#eventsOf(1); // the oldest goes, and the one after it stands alone
        this.#states.shift();
        Object.assign(this.#states[0], {shared: 0, events: second});
    }
    /* The last state, with all of its events; undefined where there is none. */
    pop() {
        const events = this.#eventsOf(this.length - 1), last = this.#states.pop();
        return last && {...last.state, events};
    }
    clear() {
        this.#states.length = 0;
    }
}
