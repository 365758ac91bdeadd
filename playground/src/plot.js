// Small plots of numbers over frames, by uPlot: lines or bars, the newest at the right. Under a pointer stands what was there.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';

const COLOURS = ['--accent', '--second', '--third'];

export class Plot {
    #rows = []; // [number of the row, a number a line]
    #next = 0;
    #chart;
    #holder;
    #top;
    #bars;
    #words;
    #room;

    /* In a holder; `words(x)` says a number, `names` those of the lines, `told(text)` hears what is under the pointer, or ''. */
    constructor(holder, {bars = false, words = (x) => x.toPrecision(2), names = [''], room = 120, told = () => {}} = {}) {
        this.#holder = holder;
        this.#bars = bars;
        this.#words = words;
        this.#room = room;
        this.#top = document.createElement('small');
        const colour = (name) => getComputedStyle(holder).getPropertyValue(name), line = (k) => () => colour(COLOURS[k]);
        this.#chart = new uPlot({
            width: 168, height: 38, padding: [11, 0, 1, 0], legend: {show: false}, axes: [{show: false}, {show: false}],
            cursor: {y: false, points: {show: !bars, size: 4}, drag: {x: false, y: false}},
            scales: {
                x: {time: false, range: () => [this.#next - room, this.#next]},
                y: {range: () => this.#range()},
            },
            series: [{}, ...names.map((_, k) => ({
                stroke: line(k), width: bars ? 0 : 1.5, points: {show: false}, ...(bars ? {fill: line(k), paths: uPlot.paths.bars({size: [0.8], align: 1})} : {}),
            }))],
            hooks: {
                setCursor: [({cursor: {idx}}) => told(idx === null || idx === undefined ? '' : this.#rows[idx].slice(1).map((x, k) => `${names[k]} ${words(x)}`.trim()).join(', '))],
            },
        }, [[], ...names.map(() => [])], holder);
        holder.append(this.#top);
        new ResizeObserver(() => this.#fit()).observe(holder);
    }
    #fit() {
        const {clientWidth: width, clientHeight: height} = this.#holder;
        if (width && height) this.#chart.setSize({width, height});
    }
    #range() {
        const all = this.#rows.flatMap((row) => row.slice(1));
        return [Math.min(0, ...all), this.#bars ? Math.max(0.5, (this.median || 0) * 2.5) : Math.max(...all, 1e-12)];
    }
    get median() {
        const sorted = this.#rows.map((row) => row[1]).sort((a, b) => a - b);
        return sorted.length ? sorted[sorted.length >> 1] : NaN;
    }
    clear() {
        this.#rows.length = 0;
        this.draw();
    }
    add(rows) {
        for (const row of rows) if (row.every(Number.isFinite)) this.#rows.push([this.#next++, ...row]);
        this.#rows.splice(0, Math.max(0, this.#rows.length - this.#room));
        this.draw();
    }
    draw() {
        const rows = this.#rows;
        this.#chart.setData(this.#chart.series.map((_, k) => rows.map((row) => row[k])));
        this.#top.textContent = rows.length ? this.#words(this.#range()[1]) : '';
    }
}
