// What undo comes back to, without a page.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {Past} from '../src/past.js';

const pull = (frame) => [frame, 'pull', 7, [0.1 * frame, 0.2, 0.3]];

test('states come back as they were, the last first, also after a branch and past the most that are kept', () => {
    const past = new Past(10), given = [];
    let events = [];
    for (let k = 0; k < 25; k++) {
        if (k === 18) events = events.slice(0, 20); // a hand in the past
        events = [...events, pull(3 * k), pull(3 * k + 1), [3 * k + 2, 'letGo']];
        given.push({frame: 3 * k + 2, events});
        past.push({frame: 3 * k + 2, events});
    }
    assert.equal(past.length, 10);
    for (const state of given.slice(-10).reverse()) assert.deepEqual(past.pop(), state);
    assert.equal(past.pop(), undefined);
    past.push({frame: 0, events: []});
    past.clear();
    assert.equal(past.length, 0);
});

test('what is kept grows with what was done, not with its square', () => {
    const past = new Past(100), events = [];
    for (let k = 0; k < 400; k++) {
        events.push(pull(2 * k), [2 * k + 1, 'letGo']);
        past.push({frame: k, events: [...events]});
    }
    assert.equal(past.kept, events.length);
});
