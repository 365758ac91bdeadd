// The lesson of one spring: two points, a constraint, dual numbers one operation after the other, and the step that brings
// it to 0. What is worked out here stands beside what the library itself says of the same spring.
import {element} from './controls.js';
import {solve, springSteps} from './dual.js';
import {Simulation} from './simulation.js';

const short = (x) => (Math.abs(x) < 1e-12 ? '0' : String(Number(x.toPrecision(4)))); // (rounding's rest is 0)
const START = {p0: [-0.5, 0.1, 0], p1: [0.5, -0.2, 0], rest: 0.5};

/* What the library makes of it: its own operations and gradient. */
async function ask(simulation, {p0, p1, rest}) {
    const scene = {
        skein: 1, name: 'spring', bodies: [{type: 'rope', count: 2, from: p0, to: p1}],
        constraints: [{type: 'formula', constraint: `length(p0 - p1) - ${rest}`, particles: [[0, 1]]}]};
    await simulation.call('open', JSON.stringify(scene), [], {}, 'spring.json');
    return simulation.call('constraint', 'constraint', 0, 0);
}

function drawing({p0, p1}, gradient, moved) {
    const place = ([x, y]) => [200 + 150 * x, 90 - 150 * y], svg = [];
    const [a, b] = [place(p0), place(p1)];
    svg.push(`<line class="spring" x1="${a[0]}" y1="${a[1]}" x2="${b[0]}" y2="${b[1]}"/>`);
    if (gradient)
        [[a, gradient.slice(0, 3)], [b, gradient.slice(3)]].forEach(([from, g]) =>
            svg.push(`<line class="gradient" marker-end="url(#head)" x1="${from[0]}" y1="${from[1]}" x2="${from[0] + 45 * g[0]}" y2="${from[1] - 45 * g[1]}"/>`));
    for (const [[x, y], name] of [[a, 'p0'], [b, 'p1']]) svg.push(`<circle cx="${x}" cy="${y}" r="7"/><text x="${x - 6}" y="${y - 13}">${name}</text>`);
    if (moved) for (const p of [moved.p0, moved.p1]) svg.push(`<circle class="moved" cx="${place(p)[0]}" cy="${place(p)[1]}" r="7"/>`);
    return `<svg viewBox="0 0 400 180" role="img" aria-label="The spring"><defs><marker id="head" viewBox="0 0 10 10" refX="8" refY="5" markerWidth="7" markerHeight="7" orient="auto"><path d="M0 0L10 5L0 10z"/></marker></defs>${svg.join('')}</svg>`;
}

let simulation = null;

export function openLesson(dialog) {
    const room = dialog.querySelector('div'), spring = structuredClone(START);
    let at = 0, asked = 0;
    simulation ??= new Simulation({onState() {}, onBroken() {}});

    const picture = element('div', {className: 'drawing'}), table = element('table'), words = element('p', {id: 'lesson-words'}), library = element('p', {id: 'lesson-library', className: 'help'});
    const back = element('button', {type: 'button', textContent: 'Back'}), next = element('button', {type: 'button', id: 'lesson-next', textContent: 'Next'}), move = element('button', {type: 'button', id: 'lesson-move', textContent: 'Move the points there'});
    const inputs = [['p0', 0], ['p0', 1], ['p0', 2], ['p1', 0], ['p1', 1], ['p1', 2], ['rest', null]].map(([name, k]) => {
        const input = element('input', {type: 'number', step: 0.1, value: k === null ? spring.rest : spring[name][k]});
        input.addEventListener('input', () => {
            const x = Number(input.value);
            if (k === null) spring.rest = x;
            else spring[name][k] = x;
            show();
        });
        return element('label', {}, k === null ? 'rest length, m ' : `${name}.${'xyz'[k]} `, input);
    });

    async function show() {
        const {notes, constraint} = springSteps(spring.p0, spring.p1, spring.rest), last = notes.length + 2;
        at = Math.max(1, Math.min(at, last));
        const found = solve(spring.p0, spring.p1, constraint), whole = at > notes.length;
        const head = element('tr', {}, ...['', 'value', '∂p0.x', '∂p0.y', '∂p0.z', '∂p1.x', '∂p1.y', '∂p1.z'].map((t) => element('th', {textContent: t})));
        table.replaceChildren(head, ...notes.slice(0, at).map(({words: name, value, slopes}, i) =>
            element('tr', {className: i === at - 1 ? 'now' : ''}, element('th', {textContent: name}), ...[value, ...slopes].map((x) => element('td', {textContent: short(x)})))));
        picture.innerHTML = drawing(spring, whole ? constraint.slopes : null, at === last ? found : null);
        const row = notes[Math.min(at, notes.length) - 1];
        words.textContent = !whole
            ? `${at} of ${last}: ${row.words} = ${short(row.value)}. ${row.why}.`
            : at < last
              ? `${at} of ${last}: the last row is C and its gradient: where C grows fastest (the arrows). |grad C|² = ${short(found.square)}.`
              : `${at} of ${last}: the points go by λ grad C with λ = -C / |grad C|² = ${short(found.lambda)}: to (${found.p0.map(short).join(', ')}) and (${found.p1.map(short).join(', ')}). There C = ${short(springSteps(found.p0, found.p1, spring.rest).constraint.value)}: a distance is so straight that one solve is enough.`;
        back.disabled = at === 1;
        next.disabled = at === last;
        move.hidden = at !== last;
        table.parentNode?.scrollTo(0, table.scrollHeight);
        const mine = ++asked, said = await ask(simulation, spring).catch((error) => ({fault: error.message}));
        if (mine !== asked) return;
        library.textContent = said.fault ?? `The library says of the same spring: C = ${short(said.value)}, gradient ${said.gradient.flat().map(short).join(' ')}.`;
        library.dataset.value = said.value;
    }
    back.addEventListener('click', () => (at--, show()));
    next.addEventListener('click', () => (at++, show()));
    move.addEventListener('click', () => {
        const {constraint} = springSteps(spring.p0, spring.p1, spring.rest), found = solve(spring.p0, spring.p1, constraint);
        Object.assign(spring, {p0: found.p0, p1: found.p1});
        [...found.p0, ...found.p1].forEach((x, i) => (inputs[i].querySelector('input').value = short(x)));
        at = 1;
        show();
    });
    room.replaceChildren(
        element('p', {textContent: 'A constraint is a number that wants to be 0: here, how much longer a spring is than at rest. A dual number carries its derivatives along; every operation knows its rule, and at the end the gradient is there, with nothing derived by hand.'}),
        element('div', {className: 'inputs'}, ...inputs), picture, words, element('div', {className: 'buttons'}, back, next, move),
        element('div', {className: 'table'}, table), library);
    show();
    dialog.showModal();
    next.focus();
}
