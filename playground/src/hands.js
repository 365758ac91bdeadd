// Hands in the picture: a particle is pulled, a pin set or taken, a hawk led.
const rounded = (xyz) => xyz.map((x) => Number(x.toFixed(4))); // of a tenth of a millimetre, so that links stay short

export function hands({app, picture, simulation, remember, tell, hint, pin, knife, hawk, beside}) {
    const {canvas} = picture;
    let held = null, stroke = null; // what is pulled; where the knife is, until the pointer goes up
    const cuts = () => knife.getAttribute('aria-pressed') === 'true';
    canvas.addEventListener('pointerdown', (event) => {
        if (event.button !== 0 || event.shiftKey || held || stroke) return;
        if (cuts()) {
            picture.controls.enabled = false;
            canvas.setPointerCapture(event.pointerId);
            stroke = {pointer: event.pointerId, clientX: event.clientX, clientY: event.clientY, noted: null};
            return;
        }
        const particle = picture.pick(event);
        if (particle === null) return;
        picture.controls.enabled = false;
        canvas.setPointerCapture(event.pointerId);
        held = {particle, through: picture.place(particle), pointer: event.pointerId, noted: null};
        app.pulled = particle;
        pin.disabled = false;
        simulation.call('isHeld', particle).then((is) => (pin.textContent = is ? 'Free' : 'Pin'));
    }, {capture: true}); // before the camera's own
    canvas.addEventListener('pointermove', (event) => {
        if (cuts()) {
            canvas.style.cursor = 'crosshair';
            if (stroke?.pointer === event.pointerId) draw(event, 6);
            return;
        }
        if (hawk.getAttribute('aria-pressed') === 'true' && !held) leadHawk(event);
        if (!held) canvas.style.cursor = picture.pick(event) === null ? '' : 'grab';
        if (held?.pointer !== event.pointerId) return;
        const place = picture.inPlane(event, held.through);
        if (!place) return;
        canvas.style.cursor = 'grabbing';
        hint.hidden = true;
        held.noted ??= remember();
        simulation.call('pull', held.particle, rounded(place));
        beside.pull(held.particle, rounded(place));
    });
    /* A stroke is cut by parts of some pixels each. */
    async function draw({clientX, clientY}, least) {
        if (Math.hypot(clientX - stroke.clientX, clientY - stroke.clientY) < least) return;
        const blade = picture.blade(stroke, {clientX, clientY}).map(rounded);
        Object.assign(stroke, {clientX, clientY});
        stroke.noted ??= remember();
        hint.hidden = true;
        simulation.call('cut', blade).then(tell);
        beside.cut(blade);
    }
    function toggleKnife() {
        if (knife.hidden) return;
        knife.setAttribute('aria-pressed', String(!cuts()));
        canvas.style.cursor = '';
    }
    knife.addEventListener('click', toggleKnife);
    const release = (event) => {
        if (stroke?.pointer === event.pointerId) {
            draw(event, 1);
            stroke = null;
            picture.controls.enabled = true;
            tell();
        }
        if (held?.pointer !== event.pointerId) return;
        if (held.noted) {
            simulation.call('letGo');
            beside.letGo();
        }
        held = null;
        picture.controls.enabled = true;
        tell();
    };
    canvas.addEventListener('pointerup', release);
    canvas.addEventListener('pointercancel', release);

    async function togglePin() {
        if (app.pulled === null) return;
        await remember();
        const is = await simulation.call('togglePin', app.pulled);
        pin.textContent = is ? 'Free' : 'Pin';
        tell();
    }
    pin.addEventListener('click', togglePin);

    /* The hawk is on the line of sight through the pointer. */
    const predator = () => app.world.objects.force.findIndex((f) => f.name === 'predator');
    let waits = false;
    async function leadHawk(event) {
        if (waits) return;
        waits = true;
        const {origin, direction} = picture.ray(event), place = `forces.${predator()}`;
        await simulation.call('set', `${place}.position`, rounded(origin));
        await simulation.call('set', `${place}.line`, rounded(direction));
        waits = false;
    }
    hawk.addEventListener('click', async () => {
        const on = hawk.getAttribute('aria-pressed') !== 'true';
        await remember();
        hawk.setAttribute('aria-pressed', String(on));
        await simulation.call('set', `forces.${predator()}.enabled`, on);
        tell();
    });
    return {togglePin, toggleKnife};
}
