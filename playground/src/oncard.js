// The choice of the graphics card for flocks, and what is said of it: milliseconds of both, how far apart they are, and that
// the hash is the card's own.
const ms = (x) => `${x.toFixed(x < 10 ? 1 : 0)} ms`;

export function offerCard({button, simulation, remember, tell, notice}) {
    let wanted = false, both = null;

    const show = (on) => button.setAttribute('aria-pressed', String((wanted = on)));
    async function choose(on) {
        show(on);
        both = null;
        try {
            both = await simulation.call('card', on);
        } catch (error) {
            show(false);
            notice(`The card does not step this scene: ${error.message}. The processor does.`);
        }
        tell();
    }
    button.addEventListener('click', async () => {
        notice('');
        await remember();
        await choose(!wanted);
    });
    return {
        choose,
        /* A world was made; `events` are what was done to it already. */
        async begun(world, events) {
            button.hidden = !world.bodies.some((body) => body.shape === 'birds');
            both = null;
            if (!events.length && wanted && !button.hidden) return choose(true);
            show(events.findLast((e) => e[1] === 'card')?.[2] === true);
            if (wanted) both = await simulation.call('bothWays');
        },
        /* What stands beside the hash, where steps were on the card; else null. */
        words(events, onCard) {
            if (!events.some((e) => e[1] === 'card' && e[2])) return null;
            const same = 'A card adds up in another order, so that no command has this hash.';
            if (onCard) return `Not on the card: ${onCard}. Steps were on it before. ${same}`;
            if (onCard === null || !both) return `Steps were on the card. ${same}`;
            return `On the card (${both.name}) a frame takes ${ms(both.card)}, on the processor ${ms(both.processor)}, and differs by ${both.apart.toExponential(0)} m. ${same}`;
        },
    };
}
