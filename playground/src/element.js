// <skein-scene src="flag.json"></skein-scene>: a scene in a page of one's own, in one line. Attributes: `src`, an address of
// a scene (its meshes lie beside it), or `scene`, the name of one of Skein's; `set`, changes as --set has them, a line each;
// `paused`; `theme` (light or dark). The element's `call` asks its worker, `open()` opens another scene.
import {Picture} from './picture.js';
import {filesOf, scenes} from './scenes.js';
import {Simulation, words} from './simulation.js';

const STYLE = `
    :host { display: block; position: relative; width: 100%; aspect-ratio: 16 / 10; overflow: hidden; border-radius: 8px; }
    :host([hidden]) { display: none; }
    .picture, .picture canvas { position: absolute; inset: 0; display: block; touch-action: none; }
    button { position: absolute; left: 10px; bottom: 10px; width: 38px; height: 38px; border-radius: 50%; border: 0; background: #fffc; color: #222; cursor: pointer; font: 15px system-ui; }
    button:focus-visible { outline: 2px solid #b23a24; }
    p { position: absolute; left: 12px; right: 12px; top: 8px; margin: 0; font: 13px/1.4 ui-monospace, monospace; color: #a33; white-space: pre-wrap; }
    p:not(:empty) { padding: .3rem .5rem; background: #fffe; border-radius: 4px; }`;

class SkeinScene extends HTMLElement {
    static observedAttributes = ['src', 'scene', 'set', 'theme'];
    #simulation = null;
    #picture = null;
    #world = null;
    #early = null;
    #playing = false;
    #lasting = '';

    connectedCallback() {
        const root = this.shadowRoot ?? this.attachShadow({mode: 'open'});
        root.innerHTML = `<style>${STYLE}</style><div class="picture" part="picture"></div><button type="button" aria-label="Play">▶</button><p role="status"></p>`;
        root.querySelector('button').addEventListener('click', () => this.call('play', !this.#playing));
        this.#simulation = new Simulation({onState: (state) => this.#take(state), onBroken: (faults) => this.#say(words(faults))});
        try {
            this.#picture = new Picture(root.querySelector('.picture'));
            this.#hands(root.querySelector('.picture'));
        } catch {
            this.#say((this.#lasting = 'This browser draws no WebGL2.'));
        }
        this.#theme();
        this.open();
    }
    disconnectedCallback() {
        this.#picture?.end();
        this.#simulation?.end();
        this.#picture = this.#simulation = this.#world = null;
    }
    attributeChangedCallback(name) {
        if (!this.#simulation) return;
        if (name === 'theme') this.#theme();
        else this.open();
    }
    #theme() {
        const wanted = this.getAttribute('theme') ?? (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
        if (this.#picture) this.#picture.dark = wanted === 'dark';
    }
    #say(text) {
        this.shadowRoot.querySelector('p').textContent = text || this.#lasting;
    }

    /* The scene of the attributes, or a scene that is given: as text or as an object. */
    async open(given = null) {
        try {
            let text = given && (typeof given === 'string' ? given : JSON.stringify(given)), files = {}, path = 'scene.json';
            if (!text && this.hasAttribute('src')) {
                const url = new URL(this.getAttribute('src'), document.baseURI), answer = await fetch(url);
                if (!answer.ok) throw new Error(`cannot fetch ${url.href}: ${answer.status}`);
                text = await answer.text();
                path = url.pathname.split('/').pop();
                files = await beside(text, url);
            } else if (!text) {
                const name = this.getAttribute('scene') ?? 'flag';
                text = scenes.get(name)?.text;
                if (!text) throw new Error(`There is no scene '${name}'.`);
                path = `scenes/${name}.json`;
                files = await filesOf(text);
            }
            const sets = (this.getAttribute('set') ?? '').split('\n').map((line) => line.trim()).filter(Boolean);
            const world = await this.call('open', text, sets, files, path);
            this.#world = world;
            this.#picture?.describe(world);
            if (this.#early?.serial === world.serial) this.#take(this.#early);
            this.#say('');
            if (!this.hasAttribute('paused')) await this.call('play', true);
            this.dispatchEvent(new CustomEvent('opened', {detail: world.settings}));
        } catch (error) {
            this.#say(error.message);
            this.dispatchEvent(new CustomEvent('fault', {detail: error.message}));
        }
    }
    call(...args) {
        return this.#simulation.call(...args);
    }
    #take(state) {
        if (state.serial !== this.#world?.serial) {
            this.#early = state;
            return;
        }
        this.state = state;
        this.#playing = state.playing;
        const button = this.shadowRoot.querySelector('button');
        button.textContent = state.playing ? '❚❚' : '▶';
        button.setAttribute('aria-label', state.playing ? 'Pause' : 'Play');
        this.#picture?.show(state);
    }
    #hands(holder) {
        const picture = this.#picture;
        let held = null;
        holder.addEventListener('pointerdown', (event) => {
            const particle = event.button === 0 && !event.shiftKey ? picture.pick(event) : null;
            if (particle === null) return;
            picture.controls.enabled = false;
            picture.canvas.setPointerCapture(event.pointerId);
            held = {particle, through: picture.place(particle)};
        }, {capture: true});
        holder.addEventListener('pointermove', (event) => {
            const place = held && picture.inPlane(event, held.through);
            if (place) this.call('pull', held.particle, place);
        });
        for (const name of ['pointerup', 'pointercancel'])
            holder.addEventListener(name, () => {
                if (held) this.call('letGo');
                held = null;
                picture.controls.enabled = true;
            });
    }
}

/* The meshes that a scene names, from beside it. */
async function beside(text, url) {
    const files = {};
    let scene = {};
    try {
        scene = JSON.parse(text);
    } catch {
        return files; // the reader says what is wrong with it, and where
    }
    const {bodies = [], colliders = []} = scene;
    for (const {mesh} of [...bodies, ...colliders])
        for (const name of mesh ? new Set([mesh, mesh.replace(/[.]node$/, '.ele')]) : []) {
            const answer = await fetch(new URL(name, url));
            if (answer.ok) files[name] = new Uint8Array(await answer.arrayBuffer());
        }
    return files;
}

if (!customElements.get('skein-scene')) customElements.define('skein-scene', SkeinScene);
export {SkeinScene};
