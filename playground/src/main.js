// The page: what is chosen and changed, and who is told. The scene and the changes (as `--set` has them) make the world;
// the address carries them; a hash says whether it is the world that the command would have.
import {fill, element} from './controls.js';
import {formulaEditor} from './formula.js';
import {read, write} from './link.js';
import {Picture} from './picture.js';
import {Plot} from './plot.js';
import {filesOf, scenes} from './scenes.js';
import {Simulation, words} from './simulation.js';

const $ = (id) => document.getElementById(id);
const notice = (text) => ($('notice').textContent = text);
const pictures = import.meta.glob('../../docs/images/{drape,flag,hanging,rope,turntable,wave,cube_bowl}.png', {query: '?url', import: 'default', eager: true});

const app = {
    scene: null, text: '', // its name, or '' for one that came by the address
    changes: new Map(), // path -> value: in this order they are the sets
    added: [], // sets that put a new object in
    world: null, state: null, touched: false, pulled: null, methods: [],
};
const plot = new Plot($('plot'));
let picture = null;
const simulation = new Simulation({
    onState: take,
    onBroken: (faults) => notice(words(faults)),
});

let early = null; // the first state of a world may come before the world's description

function take(state) {
    if (state.serial !== app.world?.serial) {
        early = state;
        return;
    }
    app.state = state;
    picture?.show(state);
    plot.add(state.spent);
    $('play').textContent = state.playing ? 'Pause' : 'Play';
    tell();
}

/* ---- the scene ---- */

const sets = () => [...app.added, ...[...app.changes].map(([path, value]) => `${path}=${JSON.stringify(value)}`)];
const path = () => (app.scene ? `scenes/${app.scene}.json` : 'scene.json');

/* Makes the world anew, from the first frame on (and on to `frame`); on a fault all stays as it is. */
async function build(frame = 0) {
    const files = await filesOf(app.text);
    const world = await simulation.call('open', app.text, sets(), files, path(), frame);
    notice('');
    app.world = world;
    app.touched = false;
    app.pulled = null;
    $('pin').disabled = true;
    plot.clear();
    picture?.describe(world);
    $('about').textContent = world.settings.description;
    document.title = `${world.settings.name || 'scene'} - Skein`;
    fillPanel();
    if (early?.serial === world.serial) take(early);
    early = null;
    return world;
}

async function open(name, {text = null, set = [], frame = 0, camera = null, play = true} = {}) {
    const before = {scene: app.scene, text: app.text, changes: app.changes, added: app.added};
    Object.assign(app, {scene: text ? '' : name, text: text ?? scenes.get(name)?.text ?? '', changes: new Map(), added: set});
    try {
        if (!app.text) throw new Error(`There is no scene '${name}' here.`);
        await simulation.call('play', false);
        await build(frame);
    } catch (error) {
        Object.assign(app, before);
        notice(error.message);
        return false;
    }
    $('scenes').value = app.scene;
    if (camera && picture) picture.camera = camera;
    if (play && !frame) await simulation.call('play', true);
    return true;
}

async function reset() {
    const playing = app.state?.playing;
    try {
        await build();
    } catch (error) {
        notice(error.message);
        return;
    }
    await simulation.call('play', Boolean(playing));
}

async function change(place, value, live) {
    const old = new Map(app.changes);
    if (place === 'method.type') for (const key of [...app.changes.keys()]) if (key.startsWith('method.')) app.changes.delete(key);
    app.changes.set(place, value);
    try {
        if (!live) await reset_with_fault();
        else {
            await simulation.call('set', place, value);
            if (app.state?.frame) app.touched = true;
            notice('');
        }
    } catch (error) {
        app.changes = old;
        notice(error.message);
        if (!live) fillPanel();
    }
    tell();
}
async function reset_with_fault() {
    const playing = app.state?.playing;
    await build();
    await simulation.call('play', Boolean(playing));
}

/* ---- the panel ---- */

const editor = formulaEditor({
    async attempt(set) {
        try {
            await simulation.call('check', app.text, [...sets(), set], await filesOf(app.text), path());
            return '';
        } catch (error) {
            return error.message;
        }
    },
    async add(set) {
        app.added.push(set);
        try {
            await reset_with_fault();
        } catch (error) {
            app.added.pop();
            notice(error.message);
        }
    },
    count: (list) => app.world?.objects[{constraints: 'constraint', forces: 'force', colliders: 'collider'}[list]].length ?? 0,
});

function fillPanel() {
    const open = editor.open;
    fill($('panel'), app.world, app.methods, app.changes, change);
    $('panel').append(editor);
    editor.open = open;
}

/* ---- what is told ---- */

const quoted = (text) => (/^[\w./=,:@%+-]+$/.test(text) ? text : `'${text.replace(/'/g, "'\\''")}'`);

function command() {
    const file = app.scene ? `scenes/${app.scene}.json` : 'scene.json';
    return ['skein run', file, ...sets().map((set) => `--set ${quoted(set)}`), `--frames ${app.state.frame}`].join(' ');
}

function tell() {
    const {state} = app;
    if (!state || !app.world) return;
    const numbers = {frame: state.frame, time: `${state.time.toFixed(2)} s`, 'ms a frame': Number.isNaN(plot.median) ? '' : plot.median.toFixed(2), particles: app.world.count, hash: state.hash};
    const list = $('numbers');
    if (list.children.length !== Object.keys(numbers).length)
        list.replaceChildren(...Object.keys(numbers).map((name) => element('div', {}, element('dt', {textContent: name}), element('dd', {id: `number-${name.split(' ')[0]}`}))));
    for (const [name, value] of Object.entries(numbers)) $(`number-${name.split(' ')[0]}`).textContent = value;
    $('hash-note').textContent = app.touched ? 'A hand or a change came in between; Reset (R) gives the same as' : 'The same hash:';
    $('command').textContent = command();
}

/* Energies now and then: they cost about a step. */
setInterval(async () => {
    if (!app.world || document.hidden) return;
    const s = await simulation.call('measure').catch(() => null);
    if (!s) return;
    const joule = (x) => `${x.toPrecision(3)} J`;
    $('numbers').title = `kinetic ${joule(s.kineticEnergy)}, potential ${joule(s.potentialEnergy)}, elastic ${joule(s.elasticEnergy)}; worst stretch ${(100 * s.maxStretch).toFixed(2)} %; contacts ${s.contacts}; memory ${(s.memoryBytes / 1e6).toFixed(1)} MB`;
}, 1000);

/* ---- hands ---- */

function hands() {
    const {canvas} = picture;
    let held = null;
    canvas.addEventListener('pointerdown', (event) => {
        if (event.button !== 0 || event.shiftKey) return;
        const particle = picture.pick(event);
        if (particle === null) return;
        picture.controls.enabled = false;
        canvas.setPointerCapture(event.pointerId);
        held = {particle, through: picture.place(particle), pointer: event.pointerId};
        app.pulled = particle;
        $('pin').disabled = false;
    }, {capture: true}); // before the camera's own
    canvas.addEventListener('pointermove', (event) => {
        if (held?.pointer !== event.pointerId) return;
        const place = picture.inPlane(event, held.through);
        if (!place) return;
        app.touched = true;
        simulation.call('pull', held.particle, place);
    });
    const release = (event) => {
        if (held?.pointer !== event.pointerId) return;
        held = null;
        picture.controls.enabled = true;
        simulation.call('letGo');
    };
    canvas.addEventListener('pointerup', release);
    canvas.addEventListener('pointercancel', release);
}

async function togglePin() {
    if (app.pulled === null) return;
    const held = await simulation.call('togglePin', app.pulled);
    app.touched = true;
    $('pin').textContent = held ? 'Free' : 'Pin';
    tell();
}

const play = () => simulation.call('play', !app.state?.playing);
const step = () => simulation.call('run', 1).catch((error) => notice(error.message));
const keys = {' ': play, ArrowRight: step, r: reset, p: togglePin, f: () => picture?.frame()};
document.addEventListener('keydown', (event) => {
    if (event.target.closest('input, textarea, select, button, dialog, summary') || event.ctrlKey || event.metaKey || event.altKey) return;
    const act = keys[event.key];
    if (!act) return;
    event.preventDefault();
    act();
});

async function link() {
    const {scene, text, state} = app;
    const hash = await write({scene, text, sets: sets(), frame: app.touched ? 0 : state.frame, camera: picture?.camera});
    return new URL(hash, location.href).href;
}
async function copy(text, button) {
    history.replaceState(null, '', text.startsWith('http') ? text : location.href);
    await navigator.clipboard?.writeText(text).catch(() => {});
    const was = button.dataset.words ?? (button.dataset.words = button.textContent);
    button.textContent = 'Copied';
    setTimeout(() => (button.textContent = was), 1200);
}

/* ---- light and dark, gallery, the page ---- */

function setTheme(dark) {
    document.documentElement.classList.toggle('dark', dark);
    if (picture) picture.dark = dark;
}

function fillGallery() {
    const cards = document.querySelector('#gallery .cards');
    if (cards.children.length) return;
    for (const {name, description} of scenes.values()) {
        const address = pictures[`../../docs/images/${name}.png`];
        const card = element('button', {type: 'button'}, ...(address ? [element('img', {src: address, alt: '', loading: 'lazy'})] : []), element('strong', {textContent: name}), element('small', {textContent: description}));
        card.addEventListener('click', () => {
            $('gallery').close();
            open(name);
        });
        cards.append(card);
    }
}

async function openAddress() {
    try {
        const asked = await read(location.hash);
        const good = asked.text || asked.scene
            ? await open(asked.scene, {text: asked.text, set: asked.sets, frame: asked.frame, camera: asked.camera})
            : await open('flag');
        if (!good && !app.world) {
            const words = $('notice').textContent;
            await open('flag');
            notice(words);
        }
    } catch (error) {
        if (!app.world) await open('flag');
        notice(`The address cannot be read: ${error.message}`);
    }
}

async function begin() {
    for (const {name} of scenes.values()) $('scenes').append(element('option', {value: name, textContent: name}));
    $('scenes').addEventListener('change', () => open($('scenes').value));
    $('gallery-open').addEventListener('click', () => {
        fillGallery();
        $('gallery').showModal();
    });
    $('play').addEventListener('click', play);
    $('step').addEventListener('click', step);
    $('reset').addEventListener('click', reset);
    $('pin').addEventListener('click', togglePin);
    $('copy-link').addEventListener('click', async () => copy(await link(), $('copy-link')));
    $('copy-command').addEventListener('click', () => copy(command(), $('copy-command')));
    const dark = matchMedia('(prefers-color-scheme: dark)');
    dark.addEventListener('change', () => setTheme(dark.matches));
    $('theme').addEventListener('click', () => setTheme(!document.documentElement.classList.contains('dark')));
    $('panel-toggle').addEventListener('click', () => {
        $('panel').hidden = !$('panel').hidden;
        $('panel-toggle').setAttribute('aria-expanded', String(!$('panel').hidden));
    });
    if (innerWidth < 760) $('panel-toggle').click();
    try {
        picture = new Picture($('picture'));
        hands();
    } catch {
        notice('This browser draws no WebGL2, so that nothing is to be seen; the simulation runs all the same.');
    }
    setTheme(dark.matches);
    app.methods = await simulation.call('kinds', 'method');
    addEventListener('hashchange', openAddress);
    await openAddress();
}

const ready = begin().catch((error) => notice(error.message));

/* For the console, and for tests. */
globalThis.skein = {
    app, ready, open, reset, change, link, command, scenes,
    run: (frames) => simulation.call('run', frames),
    call: (...args) => simulation.call(...args),
    get picture() {
        return picture;
    },
};
