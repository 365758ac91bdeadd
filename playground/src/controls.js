// The panel: every field of every object as a control, from the tables, with unit and help. `change(path, value, live)` is
// told what a hand has set.

const element = (name, properties = {}, ...children) => {
    const made = Object.assign(document.createElement(name), properties);
    made.append(...children);
    return made;
};
let last = 0;

const shown = (x) => (typeof x === 'number' ? String(Number(x.toPrecision(7))) : String(x ?? ''));
const parse = (text) => (text.trim() === 'infinite' ? 'infinite' : Number(text));

/* A slider's range: the field's where it is one that a hand can use, else some decades about the value. */
function range(field, value) {
    const {least, most} = field, x = typeof value === 'number' ? value : 1;
    if (typeof least === 'number' && typeof most === 'number' && most - least <= 1000) return {least, most, log: false};
    if (field.type === 'vec3' || field.type === 'real2') {
        const reach = Math.max(10, 3 * Math.abs(x));
        return {least: -reach, most: reach, log: false};
    }
    if (x > 0) return {least: x / 100, most: x * 100, log: true};
    return {least: Math.max(typeof least === 'number' ? least : -10, -10), most: Math.min(typeof most === 'number' ? most : 10, 10), log: false};
}

function numberControl(field, value, label, send, axis = '') {
    const box = element('div', {className: 'values'}, ...(axis ? [element('span', {className: 'axis', textContent: axis})] : []));
    const text = element('input', {type: 'text', inputMode: 'decimal', value: shown(value), spellcheck: false});
    text.setAttribute('aria-label', label);
    const {least, most, log} = range(field, value), whole = field.type.startsWith('int');
    const to = (x) => (log ? Math.log(x / least) / Math.log(most / least) : (x - least) / (most - least));
    const from = (s) => (log ? least * (most / least) ** s : least + s * (most - least));
    const slider = element('input', {type: 'range', min: 0, max: 1, step: 0.001, value: typeof value === 'number' ? to(value) : 1});
    slider.setAttribute('aria-label', `${label}, slider`);
    slider.addEventListener('input', () => {
        const x = from(Number(slider.value));
        const rounded = whole ? Math.round(x) : Number(x.toPrecision(3));
        text.value = shown(rounded);
        send(rounded);
    });
    text.addEventListener('change', () => {
        const x = parse(text.value);
        if (Number.isNaN(x)) {
            text.value = shown(value);
            return;
        }
        if (typeof x === 'number') slider.value = to(x);
        send(x);
    });
    box.append(slider, text);
    return box;
}

function control(field, value, label, send) {
    if (field.type === 'bool') {
        const box = element('input', {type: 'checkbox', checked: Boolean(value), id: label});
        box.addEventListener('change', () => send(box.checked));
        return [box];
    }
    if (field.type === 'choice') {
        const list = element('select', {id: label}, ...field.choices.map((word) => element('option', {value: word, textContent: word})));
        list.value = value;
        list.addEventListener('change', () => send(list.value));
        return [list];
    }
    if (field.type === 'text') {
        const text = element('input', {type: 'text', value: shown(value), spellcheck: false, id: label});
        text.addEventListener('change', () => send(text.value));
        return [element('div', {className: 'values'}, text)];
    }
    if (!Array.isArray(value)) return [numberControl(field, value, field.name, send)];
    const parts = [...value];
    return parts.map((x, k) =>
        numberControl(field, x, `${field.name} ${'xyz'[k]}`, (one) => {
            parts[k] = one;
            send([...parts]);
        }, parts.length === 3 ? 'xyz'[k] : ''));
}

function row(path, field, changed, change) {
    const id = `field-${++last}`, box = element('div', {className: 'field'});
    box.dataset.path = path;
    box.classList.toggle('changed', changed);
    box.classList.toggle('check', field.type === 'bool');
    const anew = field.live ? '' : 'the scene begins anew';
    box.append(
        element('label', {textContent: field.name, htmlFor: id}),
        element('span', {className: 'unit', textContent: field.unit}),
        ...control(field, field.value, id, (value) => {
            box.classList.add('changed');
            change(path, value, field.live);
        }),
        element('p', {className: 'help', textContent: [field.help, anew].filter(Boolean).join('; ')}));
    return box;
}

const LISTS = {body: 'bodies', constraint: 'constraints', force: 'forces', collider: 'colliders', motion: 'motions'};
const HIDDEN = new Set(['name']);

function section(title, path, object, changes, change, open) {
    const fields = object.fields.filter((f) => 'value' in f && !HIDDEN.has(f.name));
    const rows = fields.map((f) => row(`${path}.${f.name}`, f, changes.has(`${path}.${f.name}`), change));
    const summary = element('summary', {title: object.help}, title, ' ', element('small', {textContent: object.name === title ? '' : object.name}));
    const details = element('details', {open}, summary, ...rows);
    details.dataset.path = path;
    return details;
}

export function fill(panel, world, methods, changes, change) {
    const open = new Set([...panel.querySelectorAll('details[open]')].map((d) => d.dataset.path)), first = !open.size;
    panel.replaceChildren();
    const method = world.objects.method[0];
    const choice = element('select', {id: 'method'}, ...methods.map((m) => element('option', {value: m.name, textContent: m.name, title: m.help})));
    choice.value = method.name;
    choice.addEventListener('change', () => change('method.type', choice.value, false));
    const made = section('Method', 'method', method, changes, change, open.has('method'));
    made.firstChild.after(element('div', {className: 'field'}, element('label', {textContent: 'type', htmlFor: 'method'}), element('span'), choice, element('p', {className: 'help', textContent: methods.find((m) => m.name === method.name)?.help ?? ''})));
    panel.append(made);
    // what a newcomer wants to move comes first
    for (const category of ['force', 'body', 'collider', 'constraint', 'motion'])
        world.objects[category].forEach((object, i) => {
            const path = `${LISTS[category]}.${i}`, name = object.fields.find((f) => f.name === 'name')?.value;
            panel.append(section(name || object.name, path, object, changes, change, open.has(path) || (first && /wind|flocking/.test(object.name))));
        });
}

export {element};
