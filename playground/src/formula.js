// The editor of formulas: what is typed becomes a constraint, a force field, a collider or a rule of pairs in the scene. It
// is tried while one types: a fault shows its place by a caret, a good one what is computed, its gradient included. editor.js
// is where one types.
import {element} from './controls.js';

const onBody = (over, stiffness) => (text, body) => ({type: 'formula', constraint: text, stiffness, particles: {body, over}});
const KINDS = {
    constraint: {
        list: 'constraints', category: 'constraint', result: 'number', words: 'constraint: is to be 0, for each edge of a body',
        text: 'length(p0 - p1) - 0.9 * rest(length(p0 - p1))', object: onBody('edges', 1e4),
    },
    hinge: {
        list: 'constraints', category: 'constraint', result: 'number', words: 'hinge: is to be 0, for each hinge of a body',
        text: 'dihedral(p0, p1, p2, p3) - 0.3', object: onBody('hinges', 0.05),
    },
    force: {
        list: 'forces', category: 'force', result: 'vector', words: 'force: acts on each particle, m/s2', velocities: true,
        text: 'vec3(-p.z, 0, p.x) * 4', object: (text) => ({type: 'force_field', force: text, per: 'mass'}),
    },
    collider: {
        list: 'colliders', category: 'collider', result: 'number', words: 'collider: the distance to a solid, m',
        text: 'length(p - vec3(0, 0.5, 0)) - 0.3', object: (text) => ({type: 'formula', surface: text}),
    },
    pair: {
        list: 'forces', category: 'force', result: 'number', words: 'pair rule: towards each near bird, by relative_distance (0 to 1)',
        text: 'relative_distance - 0.5', object: (text) => ({type: 'flocking', formula: {towards: text}}),
    },
};

/* Where a fault is in a text, by its line, column and width in bytes, which are letters here: others are a fault themselves. */
function span(text, {line = 1, column = 1, width = 1, fault}) {
    const from = text.split('\n').slice(0, line - 1).reduce((sum, row) => sum + row.length + 1, 0) + column - 1;
    return {from, to: from + Math.max(width, 1), message: fault};
}

/* `attempt(set)` resolves to words of a fault or ''; `add(set)` puts it into the scene; `objects()` are those there are;
 * `call` asks the worker. */
export function formulaEditor({attempt, add, objects, call, notice}) {
    const kind = element('select', {id: 'formula-kind'}, ...Object.entries(KINDS).map(([name, {words}]) => element('option', {value: name, textContent: words})));
    kind.setAttribute('aria-label', 'What the formula is');
    const body = element('select', {id: 'formula-body'});
    body.setAttribute('aria-label', 'The body that it is on');
    // what is typed; the editor is there once it was asked for
    const place = element('div', {className: 'editor'}), typed = {value: KINDS.constraint.text, editor: null};
    const fault = element('pre', {id: 'formula-fault'});
    fault.setAttribute('role', 'status');
    const button = element('button', {type: 'button', id: 'formula-add', textContent: 'Add to the scene'});
    const graph = element('pre', {id: 'formula-graph'}), inner = element('details', {}, element('summary', {textContent: 'What is computed, gradient included'}), graph);
    const arrows = element('select', {id: 'gradient'}), number = element('input', {id: 'gradient-number', type: 'range', min: 0, max: 0, value: 0, hidden: true});
    number.setAttribute('aria-label', 'Which of the constraints');
    const shown = element('p', {id: 'gradient-words', className: 'help'});

    const set = () => {
        const {list, category, object} = KINDS[kind.value];
        return `${list}.${objects()?.[category].length ?? 0}=${JSON.stringify(object(typed.value, Number(body.value)))}`;
    };
    let waiting = 0, asked = 0;
    const look = async () => {
        const mine = ++asked, {result, velocities = false} = KINDS[kind.value];
        const words = await attempt(set()), alone = kind.value === 'pair' ? {} : await call('formula', typed.value, {result, velocities}).catch(() => ({}));
        if (mine !== asked) return; // somebody types on
        typed.editor?.mark(words && alone.fault ? span(typed.value, alone) : null);
        if (words && alone.fault) fault.replaceChildren(element('span', {textContent: `${alone.fault}\n`}), alone.shown);
        else fault.textContent = words || `It is good.${alone.warning ? ` ${alone.warning}` : ''}`;
        fault.className = words ? '' : 'good';
        button.disabled = Boolean(words);
        inner.hidden = !alone.graph;
        graph.textContent = alone.graph ?? '';
    };
    const soon = () => {
        clearTimeout(waiting);
        waiting = setTimeout(look, 150);
    };
    const suit = () => (body.hidden = kind.value !== 'constraint' && kind.value !== 'hinge');
    const write = (text) => {
        typed.value = text;
        if (typed.editor) typed.editor.text = text;
    };
    kind.addEventListener('change', () => {
        write(KINDS[kind.value].text);
        suit();
        soon();
    });
    body.addEventListener('change', soon);
    let begun = false;
    async function begin() {
        if (begun) return;
        begun = true;
        const [{edit}, functions] = await Promise.all([import('./editor.js'), call('functions')]);
        typed.editor = edit({
            parent: place, text: typed.value, functions, label: 'The formula', id: 'formula-text',
            changed(text) {
                typed.value = text;
                soon();
            },
        });
    }
    button.addEventListener('click', async () => {
        button.disabled = true;
        await add(set());
        await soon();
    });

    /* ---- gradients as arrows ---- */

    const showGradient = async () => {
        const [category, object] = arrows.value.split(' ');
        try {
            if (!category) {
                await call('showGradient', null);
                number.hidden = true;
                shown.textContent = '';
                return;
            }
            const count = category === 'force' ? 0 : await call('constraintCount', category, Number(object));
            number.hidden = count < 2;
            number.max = Math.max(0, count - 1);
            await call('showGradient', {category, object: Number(object), index: Number(number.value)});
            if (category === 'force') shown.textContent = 'The force, on up to 400 particles; the longest arrow is the strongest.';
            else {
                const c = await call('constraint', category, Number(object), Number(number.value));
                const row = (g) => g.map((x) => x.toFixed(3)).join(' ');
                shown.textContent = [`C = ${c.value.toPrecision(4)}, number ${number.value} of ${count}`, ...c.particles.map((p, i) => `by particle ${p}: ${row(c.gradient[i])}`)].join('\n');
            }
        } catch (error) {
            notice(error.message);
            arrows.value = '';
        }
    };
    arrows.addEventListener('change', () => {
        number.value = 0;
        showGradient();
    });
    number.addEventListener('input', showGradient);

    const view = element('details', {className: 'formula'}, element('summary', {textContent: 'Formula'}), kind, body, place, fault, button, inner,
        element('label', {className: 'arrows'}, 'Arrows of ', arrows), number, shown);
    view.addEventListener('toggle', () => view.open && begin().then(soon, (error) => notice(error.message)));
    suit();
    return {
        view,
        /* The world is another one. */
        refresh() {
            const there = objects(), before = body.value, name = (o, i) => o.fields.find((f) => f.name === 'name')?.value || `${o.name} ${i}`;
            body.replaceChildren(...there.body.map((o, i) => element('option', {value: i, textContent: name(o, i)})));
            body.value = there.body[before] ? before : '0';
            const rows = [];
            there.constraint.forEach((o, i) => rows.push([`constraint ${i}`, `gradient of ${name(o, i)}`]));
            there.body.forEach((o, i) => o.name !== 'flock' && rows.push([`body ${i}`, `gradients in ${name(o, i)}`]));
            there.force.forEach((o, i) => ['force_field', 'potential'].includes(o.name) && rows.push([`force ${i}`, `force of ${name(o, i)}`]));
            arrows.replaceChildren(element('option', {value: '', textContent: 'nothing'}), ...rows.map(([value, words]) => element('option', {value, textContent: words})));
            number.hidden = true;
            shown.textContent = '';
        },
    };
}
