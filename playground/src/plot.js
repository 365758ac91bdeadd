// Milliseconds of the last frames, as bars; the line is the time that a frame has at 60 Hz.
export class Plot {
    #canvas;
    #values = [];

    constructor(canvas) {
        this.#canvas = canvas;
    }
    get median() {
        const sorted = [...this.#values].sort((a, b) => a - b);
        return sorted.length ? sorted[sorted.length >> 1] : NaN;
    }
    clear() {
        this.#values.length = 0;
    }
    add(values) {
        this.#values.push(...values);
        this.#values.splice(0, Math.max(0, this.#values.length - 120));
        const {width, height} = this.#canvas, c = this.#canvas.getContext('2d'), style = getComputedStyle(this.#canvas);
        const most = Math.max(4, this.median * 2.5), at = (ms) => height - (Math.min(ms, most) / most) * (height - 2);
        c.clearRect(0, 0, width, height);
        c.fillStyle = style.getPropertyValue('--accent');
        this.#values.forEach((ms, i) => c.fillRect(2 * i, at(ms), 1.5, height - at(ms)));
        c.fillStyle = style.getPropertyValue('--faint');
        if (most > 1000 / 60) c.fillRect(0, at(1000 / 60), width, 1);
        c.font = '10px system-ui, sans-serif';
        c.fillText(`${most.toFixed(most < 10 ? 1 : 0)} ms`, 2, 10);
    }
}
