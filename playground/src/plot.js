// Small plots of numbers over time: lines or bars, the newest at the right.
const COLOURS = ['--accent', '--second', '--third'];

export class Plot {
    #canvas;
    #rows = []; // arrays of one number a line
    #bars;
    #words;
    #room;

    /* `words(most)` labels the top. */
    constructor(canvas, {bars = false, words = (x) => x.toPrecision(2), room = 120} = {}) {
        this.#canvas = canvas;
        this.#bars = bars;
        this.#words = words;
        this.#room = room;
        new ResizeObserver(() => this.draw()).observe(canvas);
    }
    get median() {
        const sorted = this.#rows.map((row) => row[0]).sort((a, b) => a - b);
        return sorted.length ? sorted[sorted.length >> 1] : NaN;
    }
    clear() {
        this.#rows.length = 0;
        this.draw();
    }
    add(rows) {
        this.#rows.push(...rows);
        this.#rows.splice(0, Math.max(0, this.#rows.length - this.#room));
        this.draw();
    }
    draw() {
        const ratio = devicePixelRatio || 1, canvas = this.#canvas, wide = canvas.clientWidth, high = canvas.clientHeight;
        if (!wide) return;
        if (canvas.width !== Math.round(wide * ratio)) Object.assign(canvas, {width: Math.round(wide * ratio), height: Math.round(high * ratio)});
        const c = canvas.getContext('2d'), style = getComputedStyle(canvas), rows = this.#rows.filter((row) => row.every(Number.isFinite));
        c.setTransform(ratio, 0, 0, ratio, 0, 0);
        c.clearRect(0, 0, wide, high);
        if (!rows.length) return;
        const all = rows.flat(), most = this.#bars ? Math.max(0.5, this.median * 2.5) : Math.max(...all, 1e-12), least = Math.min(0, ...all);
        const y = (x) => high - 1 - ((Math.min(x, most) - least) / (most - least)) * (high - 12), step = wide / this.#room;
        c.strokeStyle = style.getPropertyValue('--line');
        c.beginPath();
        c.moveTo(0, y(0));
        c.lineTo(wide, y(0));
        c.stroke();
        rows[0].forEach((_, k) => {
            c.fillStyle = c.strokeStyle = style.getPropertyValue(COLOURS[k]);
            if (this.#bars) rows.forEach(([ms], i) => c.fillRect(i * step, y(ms), Math.max(step - 0.5, 0.5), high - y(ms)));
            else {
                c.beginPath();
                rows.forEach((row, i) => c[i ? 'lineTo' : 'moveTo'](i * step, y(row[k])));
                c.lineWidth = 1.5;
                c.stroke();
            }
        });
        c.fillStyle = style.getPropertyValue('--faint');
        c.font = '10px system-ui, sans-serif';
        c.textAlign = 'right';
        c.fillText(this.#words(most), wide - 1, 9);
    }
}
