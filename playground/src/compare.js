// Methods side by side: the same scene again in a worker of its own, under another method, at the same frame, seen from the
// same place. Changes and hands go to both.
import {element} from './controls.js';
import {Picture} from './picture.js';
import {filesOf} from './scenes.js';
import {Simulation, words} from './simulation.js';

export function compare({app, stage, choice, mainPicture, sets, notice}) {
    let simulation = null, picture = null, world = null, method = '', early = null, busy = false, at = -1;

    function take(state) {
        if (state.serial !== world?.serial) {
            early = state;
            return;
        }
        at = state.frame;
        picture.show(state);
        const ms = state.spent.length ? ` · ${[...state.spent].sort((a, b) => a - b)[state.spent.length >> 1].toFixed(2)} ms` : '';
        stage.querySelector('p').textContent = `${method} · frame ${state.frame}${ms}`;
        const main = mainPicture();
        if (main) picture.camera = main.camera;
    }
    async function restart() {
        if (!method) return;
        const own = sets().filter((set) => !set.startsWith('method')), files = await filesOf(app.text, app.files);
        try {
            world = await simulation.call('open', app.text, [...own, `method={"type":"${method}"}`], files, app.path);
        } catch (error) {
            notice(`${method}: ${error.message}`);
            await choose('');
            return;
        }
        picture.describe(world);
        if (early?.serial === world.serial) take(early);
        early = null;
    }
    async function choose(name) {
        method = name;
        stage.hidden = !method;
        choice.value = method;
        if (!method) {
            picture?.end();
            simulation?.end();
            simulation = picture = world = null;
            return;
        }
        simulation ??= new Simulation({onState: take, onBroken: (faults) => notice(words(faults))});
        picture ??= new Picture(stage.querySelector('.picture'));
        picture.dark = document.documentElement.classList.contains('dark');
        const main = mainPicture();
        if (main) main.onDrawn = () => picture && picture.camera.some((x, k) => x !== main.camera[k]) && (picture.camera = main.camera);
        main?.resize(); // which has half of the room now
        main?.frame();
        await restart();
        if (app.state) follow();
    }
    async function follow() {
        if (!world || busy) return;
        busy = true;
        for (let last = -1; world && app.state.frame !== at && at !== last; ) {
            last = at;
            at = await simulation.call('follow', app.state.frame).catch((error) => {
                notice(`${method}: ${error.message}`);
                return at;
            });
        }
        busy = false;
    }
    const tell = (...args) => world && simulation.call(...args).catch(() => {}); // the other may lack a field
    return {
        offer(methods) {
            choice.append(element('option', {value: '', textContent: 'nothing'}), ...methods.map((m) => element('option', {value: m.name, textContent: m.name, title: m.help})));
            choice.addEventListener('change', () => choose(choice.value));
        },
        choose, restart, follow,
        pull: (...args) => tell('pull', ...args),
        letGo: () => tell('letGo'),
        cut: (blade) => tell('cut', blade),
        change: (path, value) => !path.startsWith('method') && tell('set', path, value),
        dark(on) {
            if (picture) picture.dark = on;
        },
        get at() {
            return world ? at : null;
        },
    };
}
