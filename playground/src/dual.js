// Dual numbers: a value that carries its derivatives along, as include/skein/dual.h has them; each operation is noted, so
// that it can be shown.

export class Dual {
    /* `notes` receives {words, dual} of each operation. */
    constructor(value, slopes, notes = null) {
        this.value = value;
        this.slopes = slopes;
        this.notes = notes;
    }
    /* A control: its own derivative is 1, all others are 0. */
    static seed(value, index, count, notes, words) {
        return new Dual(value, Array.from({length: count}, (_, i) => Number(i === index)), notes).note(words, 'a control: its own derivative is 1');
    }
    note(words, why) {
        this.notes?.push({words, why, value: this.value, slopes: [...this.slopes]});
        return this;
    }
    sub(b, words) {
        return new Dual(this.value - b.value, this.slopes.map((s, i) => s - b.slopes[i]), this.notes).note(words, "(a - b)' = a' - b'");
    }
    add(b, words) {
        return new Dual(this.value + b.value, this.slopes.map((s, i) => s + b.slopes[i]), this.notes).note(words, "(a + b)' = a' + b'");
    }
    square(words) {
        return new Dual(this.value * this.value, this.slopes.map((s) => 2 * this.value * s), this.notes).note(words, "(a²)' = 2 a a'");
    }
    sqrt(words) { // at 0 the derivative is 0, so that points that coincide make no NaN
        const root = Math.sqrt(Math.max(0, this.value)), slope = this.value > Number.MIN_VALUE ? 1 / (2 * root) : 0;
        return new Dual(root, this.slopes.map((s) => slope * s), this.notes).note(words, "(√a)' = a' / (2 √a)");
    }
    less(x, words) {
        return new Dual(this.value - x, [...this.slopes], this.notes).note(words, 'a plain number has no derivatives');
    }
}

/* The constraint of one spring, C = |p0 - p1| - L, with all its operations. */
export function springSteps(p0, p1, rest) {
    const notes = [], seeds = [...p0, ...p1].map((x, i) => Dual.seed(x, i, 6, notes, `p${Math.floor(i / 3)}.${'xyz'[i % 3]}`));
    const d = [0, 1, 2].map((k) => seeds[k].sub(seeds[3 + k], `d${'xyz'[k]} = p0.${'xyz'[k]} - p1.${'xyz'[k]}`));
    const squares = d.map((x, k) => x.square(`d${'xyz'[k]}²`));
    const sum = squares[0].add(squares[1], 'dx² + dy²').add(squares[2], 'dx² + dy² + dz²');
    const constraint = sum.sqrt('length = √(dx² + dy² + dz²)').less(rest, `C = length - ${rest}`);
    return {notes, constraint};
}

/* Where one solve brings the points: by -C / |grad C|² grad C. */
export function solve(p0, p1, {value, slopes}) {
    const square = slopes.reduce((sum, s) => sum + s * s, 0), lambda = square > 0 ? -value / square : 0;
    const moved = [...p0, ...p1].map((x, i) => x + lambda * slopes[i]);
    return {square, lambda, p0: moved.slice(0, 3), p1: moved.slice(3)};
}
