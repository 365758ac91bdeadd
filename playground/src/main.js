// The page: what is chosen and changed, and who is told. The scene, the changes (as `--set` has them) and what was done on
// the way make the world; the address carries them; a hash says whether it is the world that the command would have.
import {compare} from './compare.js';
import {fill, element} from './controls.js';
import {offerFiles} from './files.js';
import {formulaEditor} from './formula.js';
import {hands} from './hands.js';
import {openLesson} from './lesson.js';
import {MOST, read, write} from './link.js';
import {offerCard} from './oncard.js';
import {Past} from './past.js';
import {Picture} from './picture.js';
import {Plot} from './plot.js';
import {filesOf, scenes} from './scenes.js';
import {Simulation, words} from './simulation.js';

const $ = (id) => document.getElementById(id);
let lasting = ''; // what is missing here stays said
const notice = (text) => ($('notice').textContent = text || lasting);

const app = {
    scene: null, text: '', path: '', files: {}, // its name, or null and a text of one's own with its meshes
    changes: new Map(), // path -> value: in this order they are the sets
    added: [], // sets that put a new object in
    built: [], // the sets that the world was built with
    world: null, state: null, pulled: null, methods: [], undo: new Past(),
};
let picture = null;
/* In J, with a thousand or a million of them in a word, and 0 where rounding has left a crumb. */
const joule = (x) => {
    const [scale, unit] = [[1e6, 'MJ'], [1e3, 'kJ'], [1, 'J'], [1e-3, 'mJ']].find(([least]) => Math.abs(x) >= least) ?? [1, 'J'];
    return Math.abs(x) < 1e-6 ? '0 J' : `${Number((x / scale).toPrecision(3))} ${unit}`;
};
const percent = (x) => (Math.abs(x) < 1e-6 ? '0 %' : `${(100 * x).toPrecision(2)} %`);
const simulation = new Simulation({onState: take, onBroken: (faults) => notice(words(faults))});
/* What is under the pointer in a plot stands where the newest number stood. */
const pointed = (id) => (text) => {
    $(id).dataset.pointed = text;
    if (text) $(id).textContent = text;
};
const number = (id, text) => $(id).dataset.pointed || ($(id).textContent = text);
const plots = {
    ms: new Plot($('plot-ms'), {bars: true, words: (x) => `${x.toFixed(x < 10 ? 1 : 0)} ms`, told: pointed('number-ms')}),
    energy: new Plot($('plot-energy'), {words: joule, names: ['kinetic', 'elastic', 'potential'], told: pointed('number-energy')}),
    stretch: new Plot($('plot-stretch'), {words: percent, told: pointed('number-stretch')}),
};

let early = null; // the first state of a world may come before the world's description

function take(state) {
    if (state.serial !== app.world?.serial) {
        early = state;
        return;
    }
    app.state = state;
    picture?.show(state);
    plots.ms.add(state.spent.map((ms) => [ms]));
    beside.follow(state);
    $('play').classList.toggle('playing', state.playing);
    $('play').setAttribute('aria-label', state.playing ? 'Pause' : 'Play');
    tell();
}

/* ---- the scene ---- */

const sets = () => [...app.added, ...[...app.changes].map(([path, value]) => `${path}=${JSON.stringify(value)}`)];
const source = () => [app.text, app.path];

/* Makes the world anew, from the first frame on, and on to `frame` with what was done; on a fault all stays as it is. */
async function build(frame = 0, events = []) {
    const built = sets(), files = await filesOf(app.text, app.files);
    const world = await simulation.call('open', app.text, built, files, app.path, frame, events);
    notice('');
    Object.assign(app, {world, built, pulled: null});
    $('pin').disabled = true;
    for (const plot of Object.values(plots)) plot.clear();
    picture?.describe(world);
    if (early?.serial === world.serial) take(early);
    early = null;
    $('about').textContent = world.settings.description;
    document.title = `${world.settings.name || 'scene'} - Skein`;
    const predator = world.objects.force.findIndex((f) => f.name === 'predator');
    $('hawk').hidden = predator < 0;
    $('hawk').setAttribute('aria-pressed', 'false');
    $('knife').hidden = !world.bodies.some((body) => body.faceSizes.length);
    if ($('knife').hidden) $('knife').setAttribute('aria-pressed', 'false');
    fillPanel();
    measure();
    await onCard.begun(world, events);
    await beside.restart();
    return world;
}

const kept = () => ({scene: app.scene, text: app.text, path: app.path, files: app.files, changes: new Map(app.changes), added: [...app.added], built: app.built});

async function open(name, {text = null, path = 'scene.json', files = {}, set = [], events = [], frame = 0, camera = null, play = true} = {}) {
    const before = kept(), own = text !== null || !name;
    Object.assign(app, {
        scene: own ? null : name, text: own ? text ?? '' : scenes.get(name)?.text ?? '', files: own ? files : {},
        path: own ? path : `scenes/${name}.json`, changes: new Map(), added: [...set]});
    try {
        if (!app.text && !Object.keys(files).length) throw new Error(`There is no scene '${name}' here.`);
        await simulation.call('play', false);
        await build(frame, events);
    } catch (error) {
        Object.assign(app, before);
        notice(error.message);
        return false;
    }
    app.undo.clear();
    showScene();
    if (camera && picture) picture.camera = camera;
    if (play && !frame) await simulation.call('play', true);
    return true;
}

function showScene() {
    const own = $('scenes').querySelector('[value=""]');
    own.hidden = Boolean(app.scene);
    own.textContent = app.path.split('/').pop();
    $('scenes').value = app.scene ?? '';
    $('undo').disabled = !app.undo.length;
}

async function reset() {
    const {playing} = app.state ?? {};
    try {
        await build();
    } catch (error) {
        notice(error.message);
        return;
    }
    await simulation.call('play', Boolean(playing));
}

/* What undo comes back to: noted before a change or a hand. */
async function remember() {
    const state = {...kept(), ...(await simulation.call('where')), playing: app.state.playing};
    app.undo.push(state);
    $('undo').disabled = false;
    return state;
}
async function undo() {
    const last = app.undo.pop();
    if (!last) return;
    const now = kept(), {frame, events, playing, built, ...rest} = last;
    Object.assign(app, {...rest, changes: new Map(), added: built}); // as it was built; changes on the way are among the events
    try {
        await build(frame, events);
    } catch (error) {
        Object.assign(app, now);
        notice(error.message);
        return;
    }
    Object.assign(app, {changes: rest.changes, added: rest.added});
    fillPanel();
    showScene();
    tell();
    await simulation.call('play', playing);
}

let changing = {path: '', at: 0}; // one slider's way is one change to undo
async function change(path, value, live) {
    const now = performance.now();
    if (path !== changing.path || now - changing.at > 1000) await remember();
    changing = {path, at: now};
    const old = new Map(app.changes);
    if (path === 'method.type') for (const key of [...app.changes.keys()]) if (key.startsWith('method.')) app.changes.delete(key);
    app.changes.set(path, value);
    try {
        if (!live) await reset_with_fault();
        else {
            const frame = await simulation.call('set', path, value);
            if (!frame) app.built = sets(); // before the first step it is a part of the beginning
            notice('');
            beside.change(path, value);
        }
    } catch (error) {
        app.changes = old;
        app.undo.pop();
        notice(error.message);
        if (!live) fillPanel();
    }
    tell();
}
async function reset_with_fault() {
    const {playing} = app.state ?? {};
    await build();
    await simulation.call('play', Boolean(playing));
}

/* ---- the panel ---- */

const editor = formulaEditor({
    async attempt(set) {
        try {
            const [text, path] = source();
            await simulation.call('check', text, [...sets(), set], await filesOf(text, app.files), path);
            return '';
        } catch (error) {
            return error.message;
        }
    },
    async add(set) {
        await remember();
        app.added.push(set);
        try {
            await reset_with_fault();
        } catch (error) {
            app.added.pop();
            app.undo.pop();
            notice(error.message);
        }
    },
    objects: () => app.world?.objects,
    call: (...args) => simulation.call(...args),
    notice,
});

function fillPanel() {
    fill($('panel'), app.world, app.methods, app.changes, change);
    $('panel').append(editor.view);
    editor.refresh();
}

/* ---- what is told ---- */

const quoted = (text) => (/^[\w./=,:@%+-]+$/.test(text) ? text : `'${text.replace(/'/g, "'\\''")}'`);

/* The command that gives the same: with changes on the way, `skein record`, which takes them by steps; null where a hand
 * came in, which no command has. */
function command(events, frame = app.state.frame) {
    if (events.some((e) => e[1] !== 'set')) return null;
    const {stepsPerFrame} = app.world.settings, name = app.path.split('/').pop().replace(/[.]\w+$/, '');
    const given = [app.path, ...app.built.map((set) => `--set ${quoted(set)}`)];
    if (!events.some(([f]) => f < frame)) return ['skein run', ...given, `--frames ${frame}`].join(' ');
    const at = events.filter(([f]) => f < frame).map(([f, , path, value]) => `--at ${quoted(`${f * stepsPerFrame} ${path}=${JSON.stringify(value)}`)}`);
    return ['skein record', ...given, ...at, `--frames ${frame} -o ${name}.skeinrec`].join(' ');
}

let told = {done: -1, serial: -1, line: ''}, telling = false;
async function tellCommand() {
    const {state} = app;
    if (telling) return;
    telling = true;
    if (told.done !== state.done || told.serial !== state.serial || told.branch !== state.branch)
        told = {done: state.done, serial: state.serial, branch: state.branch, events: state.done ? await simulation.call('events') : []};
    telling = false;
    const line = command(told.events);
    $('hash-note').textContent = line ? 'The same hash:' : onCard.words(told.events, state.onCard) ?? 'A hand was at work: the link has it, and gives the same hash.';
    $('command').textContent = line ?? '';
    $('command').hidden = $('copy-command').hidden = !line;
}

function tell() {
    const {state} = app;
    if (!state || !app.world) return;
    const numbers = {time: `${state.time.toFixed(2)} s`, particles: app.world.count.toLocaleString('en'), hash: state.hash};
    const list = $('numbers');
    if (!list.children.length)
        list.replaceChildren(...Object.keys(numbers).map((name) => element('div', {}, element('dt', {textContent: name}), element('dd', {id: `number-${name}`}))));
    for (const [name, value] of Object.entries(numbers)) $(`number-${name}`).textContent = value;
    number('number-ms', Number.isNaN(plots.ms.median) ? '-' : `${plots.ms.median.toFixed(2)} ms`);
    const line = $('timeline');
    line.max = state.end;
    if (!line.matches(':active')) line.value = state.frame;
    $('frames').textContent = state.frame < state.end ? `${state.frame} of ${state.end}` : `${state.frame}`;
    const branch = $('branch');
    branch.hidden = state.branches < 2;
    if (branch.options.length !== state.branches)
        branch.replaceChildren(...Array.from({length: state.branches}, (_, i) => element('option', {value: i, textContent: `branch ${i + 1}`})));
    branch.value = state.branch;
    tellCommand();
}

/* Energies now and then: they cost about a step. */
async function measure() {
    if (!app.world || document.hidden) return;
    const s = await simulation.call('measure').catch(() => null);
    if (!s) return;
    const total = s.kineticEnergy + s.potentialEnergy + s.elasticEnergy;
    plots.energy.add([[s.kineticEnergy, s.elasticEnergy, s.potentialEnergy]]);
    plots.stretch.add([[s.maxStretch]]);
    number('number-energy', joule(total));
    number('number-stretch', `${(100 * s.maxStretch).toFixed(2)} %`);
    $('plot-energy').title = `kinetic ${joule(s.kineticEnergy)} (red), elastic ${joule(s.elasticEnergy)} (teal), potential ${joule(s.potentialEnergy)} (amber)`;
    $('numbers').title = `contacts ${s.contacts}; memory ${(s.memoryBytes / 1e6).toFixed(1)} MB`;
}
setInterval(() => app.state?.playing && measure(), 250);

/* ---- time ---- */

const play = () => simulation.call('play', !app.state?.playing);
const step = () => simulation.call('run', 1).then(measure).catch((error) => notice(error.message));
const back = () => seek(Math.max(0, app.state.frame - 1));
let wanted = null;
async function seek(frame) { // one at a time, and then the last that was wanted
    const busy = wanted !== null;
    wanted = frame;
    if (busy) return;
    for (let now = null; now !== wanted; ) {
        now = wanted;
        await simulation.call('seek', now).catch((error) => notice(error.message));
    }
    wanted = null;
    measure();
}
async function switchTo(branch) {
    app.world.objects = await simulation.call('switchTo', branch);
    fillPanel();
}

async function link() {
    const {scene, text, path, files, built} = app, {frame, events} = await simulation.call('where');
    const hash = await write({scene, text, path, files, sets: built, events, frame, camera: picture?.camera});
    return new URL(hash, location.href).href;
}
async function copy(text, button) {
    await navigator.clipboard?.writeText(text).catch(() => {});
    const label = button.querySelector('span') ?? button, was = button.dataset.words ?? (button.dataset.words = label.textContent);
    label.textContent = 'Copied';
    button.classList.add('done');
    setTimeout(() => {
        label.textContent = was;
        button.classList.remove('done');
    }, 1200);
}
async function copyLink() {
    const text = await link();
    if (text.length > MOST) {
        notice(`This state takes a link of ${Math.round(text.length / 1024)} KB, which is too long; save the scene instead (More).`);
        return;
    }
    history.replaceState(null, '', text);
    await copy(text, $('copy-link'));
}

/* ---- light and dark, gallery, the page ---- */

function setTheme(dark) {
    document.documentElement.classList.toggle('dark', dark);
    if (picture) picture.dark = dark;
    beside.dark(dark);
    for (const plot of Object.values(plots)) plot.draw();
}

function fillGallery() {
    const cards = document.querySelector('#gallery .cards');
    if (cards.children.length) return;
    for (const {name, description, picture: address} of scenes.values()) {
        const image = address ? [element('img', {src: address, alt: '', loading: 'lazy', width: 256, height: 144})] : [];
        const card = element('button', {type: 'button'}, ...image, element('strong', {textContent: name}), element('small', {textContent: description}));
        card.addEventListener('click', () => {
            $('gallery').close();
            open(name);
        });
        cards.append(card);
    }
}
function openGallery() {
    fillGallery();
    $('gallery').showModal();
}
function togglePanel() {
    $('panel').hidden = !$('panel').hidden;
    $('panel-toggle').setAttribute('aria-expanded', String(!$('panel').hidden));
}

const onCard = offerCard({button: $('card'), simulation, remember, tell, notice});
const beside = compare({app, stage: $('other-stage'), choice: $('compare'), mainPicture: () => picture, sets, notice});

async function openAddress() {
    try {
        const asked = await read(location.hash), {events, frame, camera} = asked;
        const own = {text: asked.text, path: asked.path, files: asked.files};
        const good = asked.text !== null || asked.scene
            ? await open(asked.scene, {...(asked.text !== null ? own : {}), set: asked.sets, events, frame, camera})
            : await open('flag');
        if (!good && !app.world) {
            const why = $('notice').textContent;
            await open('flag');
            notice(why);
        }
    } catch (error) {
        if (!app.world) await open('flag');
        notice(`The address could not be read: ${error.message}`);
    }
}

const keys = {
    ' ': play, ArrowRight: step, ArrowLeft: back, r: reset, p: () => theHands?.togglePin(), k: () => theHands?.toggleKnife(), f: () => picture?.frame(), z: undo,
    '+': () => picture?.turn(0, 0, 1.15), '-': () => picture?.turn(0, 0, 1 / 1.15), g: openGallery, c: togglePanel, '?': () => $('keys').showModal(),
};
const turns = {ArrowRight: [8, 0], ArrowLeft: [-8, 0], ArrowUp: [0, 6], ArrowDown: [0, -6]}; // with the shift key
let theHands = null;

async function begin() {
    const list = [...scenes.keys()].map((name) => element('option', {value: name, textContent: name}));
    $('scenes').append(element('option', {value: '', hidden: true}), ...list);
    $('scenes').addEventListener('change', (event) => open(event.target.value));
    const clicks = {
        'gallery-open': openGallery, play, step, reset, undo, 'copy-link': copyLink, 'panel-toggle': togglePanel,
        'copy-command': () => copy($('command').textContent, $('copy-command')),
        'keys-open': () => $('keys').showModal(), 'lesson-open': () => openLesson($('lesson')),
        theme: () => setTheme(!document.documentElement.classList.contains('dark')),
    };
    for (const [id, act] of Object.entries(clicks)) $(id).addEventListener('click', act);
    $('compare').addEventListener('change', () => ($('menu').open = false));
    $('menu').addEventListener('click', (event) => event.target.closest('button') && ($('menu').open = false));
    addEventListener('pointerdown', (event) => event.target.closest?.('#menu') ?? ($('menu').open = false));
    $('timeline').addEventListener('input', (event) => seek(Number(event.target.value)));
    $('branch').addEventListener('change', (event) => switchTo(Number(event.target.value)));
    document.addEventListener('keydown', (event) => {
        if (event.target.closest('input, textarea, select, button, dialog, summary, [contenteditable]') || event.ctrlKey || event.metaKey || event.altKey) return;
        const turn = event.shiftKey && turns[event.key], act = turn ? () => picture?.turn(...turn) : keys[event.key];
        if (!act) return;
        event.preventDefault();
        act();
    });
    const dark = matchMedia('(prefers-color-scheme: dark)');
    dark.addEventListener('change', () => setTheme(dark.matches));
    if (innerWidth < 760) togglePanel();
    await painted(); // what there is of the page is seen before the card is asked for anything
    try {
        picture = new Picture($('picture'));
        theHands = hands({app, picture, simulation, remember, tell, hint: $('hint'), pin: $('pin'), knife: $('knife'), hawk: $('hawk'), beside});
    } catch {
        notice((lasting = 'This browser draws no WebGL2, so that nothing is to be seen; the simulation runs all the same.'));
    }
    setTheme(dark.matches);
    offerFiles({app, $, simulation, open, notice, picture: () => picture});
    app.methods = await simulation.call('kinds', 'method').catch((error) => {
        throw new Error(`Skein could not be started: ${error.message}. It needs WebAssembly with SIMD (Chrome 91, Firefox 89, Safari 16.4).`);
    });
    beside.offer(app.methods);
    setTimeout(() => ($('hint').hidden = true), 25000); // it was read, or is in the way
    addEventListener('hashchange', openAddress);
    await openAddress();
    if ('serviceWorker' in navigator && import.meta.env.PROD) keepOffline();
}

const painted = () => new Promise((resolve) => {
    requestAnimationFrame(() => setTimeout(resolve));
    setTimeout(resolve, 200); // where nothing is painted: a page in the background
});

/* From the second visit on, and without a network, everything comes from this browser. */
async function keepOffline() {
    try {
        await navigator.serviceWorker.register('./sw.js');
        const {active} = await navigator.serviceWorker.ready;
        setTimeout(() => active.postMessage('all'), 8000); // pictures and meshes, when there is time
    } catch {
        // a file:// page, say: it works, with a network
    }
}

const ready = begin().catch((error) => notice(error.message));

/* For the console, and for tests. */
globalThis.skein = {
    app, ready, open, reset, change, undo, seek, link, scenes, measure,
    command: async () => {
        const {events, frame} = await simulation.call('where');
        return command(events, frame);
    },
    run: (frames) => simulation.call('run', frames),
    call: (...args) => simulation.call(...args),
    get picture() {
        return picture;
    },
    get beside() {
        return beside;
    },
};
