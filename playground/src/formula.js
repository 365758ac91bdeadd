// The editor of formulas: what is typed becomes a constraint, a force field or a collider of the scene, and is tried while
// one types, so that a fault shows its place by a caret.
import {element} from './controls.js';

const KINDS = {
    constraint: {
        list: 'constraints', words: 'is to be 0, for each edge of a body',
        text: 'length(p0 - p1) - 0.9 * rest(length(p0 - p1))',
        object: (text, body) => ({type: 'formula', constraint: text, stiffness: 1e4, particles: {body, over: 'edges'}}),
    },
    hinge: {
        list: 'constraints', words: 'is to be 0, for each hinge of a body',
        text: 'dihedral(p0, p1, p2, p3) - 0.3',
        object: (text, body) => ({type: 'formula', constraint: text, stiffness: 0.05, particles: {body, over: 'hinges'}}),
    },
    force: {
        list: 'forces', words: 'acts on each particle, m/s2',
        text: 'vec3(-p.z, 0, p.x) * 4',
        object: (text) => ({type: 'force_field', force: text, per: 'mass'}),
    },
    collider: {
        list: 'colliders', words: 'is the distance to a solid, m',
        text: 'length(p - vec3(0, 0.5, 0)) - 0.3',
        object: (text) => ({type: 'formula', surface: text}),
    },
};

/* `attempt(set)` resolves to words of a fault or ''; `add(set)` puts it into the scene; `count(list)` is how many there are. */
export function formulaEditor({attempt, add, count}) {
    const kind = element('select', {id: 'formula-kind'}, ...Object.entries(KINDS).map(([name, {words}]) => element('option', {value: name, textContent: `${name}: ${words}`})));
    const text = element('textarea', {id: 'formula-text', rows: 3, spellcheck: false, value: KINDS.constraint.text});
    text.setAttribute('aria-label', 'The formula');
    const fault = element('pre', {id: 'formula-fault'});
    fault.setAttribute('role', 'status');
    const button = element('button', {type: 'button', id: 'formula-add', textContent: 'Add to the scene'});
    const set = () => {
        const {list, object} = KINDS[kind.value];
        return `${list}.${count(list)}=${JSON.stringify(object(text.value, 0))}`;
    };
    let waiting = 0, asked = 0;
    const look = async () => {
        const mine = ++asked, words = await attempt(set());
        if (mine !== asked) return; // somebody types on
        fault.textContent = words || 'It is good.';
        fault.className = words ? '' : 'good';
        button.disabled = Boolean(words);
    };
    const soon = () => {
        clearTimeout(waiting);
        waiting = setTimeout(look, 150);
    };
    kind.addEventListener('change', () => {
        text.value = KINDS[kind.value].text;
        soon();
    });
    text.addEventListener('input', soon);
    button.addEventListener('click', () => add(set()));
    const details = element('details', {className: 'formula'}, element('summary', {textContent: 'Formula'}), kind, text, fault, button);
    details.addEventListener('toggle', () => details.open && soon());
    return details;
}
