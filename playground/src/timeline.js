// What was done to a world and where it has been, so that one can go back and on again: hands and changes by the frame
// before whose steps they came, and snapshots now and then. That steps go to the graphics card from now on is such a change. Going to a frame takes the last snapshot before it and does
// again what followed, which gives the same bits. A hand in the past begins a branch; the old way on is kept beside it.
const MOST_BRANCHES = 6;

export class Timeline {
    #ways = [{events: [], end: 0, kept: []}]; // events: [frame, call, ...arguments]; kept: {frame, bytes, events}
    #way = 0;
    #next = 0; // the first event that is not done to the world as it stands
    #every = 10;
    #holding = false;
    #onCard = false;
    #most;
    card = null; // what steps there, see card.js; without one the processor does it

    /* Snapshots take at most so many bytes; where they would take more, every second one goes. */
    constructor(world, mostBytes = 128e6) {
        this.world = world;
        this.#most = mostBytes;
        this.#keep();
    }
    get #now() {
        return this.#ways[this.#way];
    }
    get frame() {
        return this.world.frame;
    }
    get end() {
        return this.#now.end;
    }
    get branch() {
        return this.#way;
    }
    get branches() {
        return this.#ways.length;
    }
    get bytes() {
        return this.#ways.reduce((sum, {kept}) => sum + kept.reduce((all, {bytes}) => all + bytes.length, 0), 0);
    }
    /* Why the steps that are to be on the card are not, or '' where they are; null: they are not to be. */
    get onCard() {
        if (!this.#onCard) return null;
        return this.card?.why(this.world) ?? 'there is none here';
    }
    /* What was done up to here. */
    get events() {
        return this.#now.events.slice(0, this.#next);
    }

    #keep() {
        const way = this.#now;
        way.kept.push({frame: this.frame, bytes: this.world.snapshot(), events: this.#next, onCard: this.#onCard});
        const bytes = this.#ways.reduce((sum, {kept}) => sum + kept.length, 0) * way.kept[0].bytes.length;
        if (bytes <= this.#most) return;
        this.#every *= 2;
        for (const each of this.#ways) each.kept = each.kept.filter(({frame}) => frame % this.#every === 0);
    }

    /* A hand or a change, now: what had come later goes on in a branch of its own. */
    act(call, ...args) {
        this.#fork();
        const {events} = this.#now, last = events.at(-1), {frame} = this;
        const event = [frame, call, ...args];
        this.#do(event);
        // of several places or values for one thing before a step, the last counts
        const again = last?.[0] === frame && last[1] === call && last[2] === args[0] && (call === 'pull' || call === 'set');
        if (again) events.pop();
        events.push(event);
        this.#next = events.length;
    }
    #fork() {
        const {events, end, kept} = this.#now, {frame} = this;
        if (frame >= end && this.#next >= events.length) return;
        const mine = {events: events.slice(0, this.#next), end: frame, kept: kept.filter((k) => k.frame <= frame && k.events <= this.#next)};
        if (this.#ways.length === MOST_BRANCHES) this.#ways.splice(this.#way === 0 ? 1 : 0, 1);
        this.#ways.push(mine);
        this.#way = this.#ways.length - 1;
    }
    #do([, call, ...args]) {
        const {world} = this;
        this.card?.forget();
        if (call === 'pull') world.pull(args[0], args.slice(1));
        else if (call === 'cut') world.cut(args[0], [0, 3, 6].map((k) => args.slice(k + 1, k + 4)));
        else if (call === 'card') this.#onCard = args[0];
        else if (['set', 'pin', 'release', 'letGo'].includes(call)) world[call](...args);
        else throw new TypeError(`nothing is called ${call}`);
        this.#holding = call === 'pull' || (this.#holding && call !== 'letGo');
    }

    /* A frame on; what was done before it, is done. */
    advance() {
        const {events} = this.#now, {frame} = this;
        for (; this.#next < events.length && events[this.#next][0] <= frame; this.#next++) this.#do(events[this.#next]);
        if (this.onCard === '' && !this.#holding) this.card.step(this.world); // (a hand leads on the processor)
        else this.world.step(1);
        const now = this.frame;
        if (now <= this.#now.end) return;
        this.#now.end = now;
        if (now % this.#every === 0 && !this.#holding) this.#keep();
    }
    /* To a frame, back or on; `each` is told of every frame on the way. */
    seek(frame, each = null) {
        const here = this.frame;
        let from = this.#now.kept[0];
        for (const kept of this.#now.kept) if (kept.frame <= frame && kept.frame > from.frame) from = kept;
        if (frame < here || from.frame > here) this.#restore(from);
        this.#goOn(frame, each);
    }
    #restore(kept) {
        this.world.letGo();
        this.world.restore(kept.bytes);
        this.#holding = false;
        this.#onCard = kept.onCard;
        this.card?.forget();
        this.#next = kept.events;
    }
    #goOn(frame, each = null) {
        while (this.frame < frame) {
            this.advance();
            each?.(this.frame);
        }
        const {events, end} = this.#now;
        if (frame >= end) for (; this.#next < events.length && events[this.#next][0] <= frame; this.#next++) this.#do(events[this.#next]);
    }
    /* From the first frame on; `each` is told of that one, too. */
    runThrough(frame, each) {
        this.#restore(this.#now.kept[0]);
        each(this.frame);
        this.#goOn(frame, each);
    }
    /* Does what came with a link, up to a frame. */
    replay(events, frame) {
        this.#now.events = events;
        this.#goOn(frame);
        this.#now.events = this.events;
    }
    /* Over to another branch, at the same frame or its end. */
    switchTo(branch) {
        const {frame} = this;
        if (!this.#ways[branch]) return;
        this.#way = branch;
        const to = Math.min(frame, this.#now.end);
        this.#restore(this.#now.kept[0]);
        this.seek(to);
    }
    /* What is set before the first step belongs to the beginning. */
    begin() {
        this.card?.forget();
        this.#now.kept = [];
        this.#keep();
    }
}
