// The editor of a formula's text, by CodeMirror: colours, brackets that belong together, names as one types, and a fault
// underlined where it is. It comes when it is first wanted, for it is a third of the page.
import {autocompletion, completionKeymap} from '@codemirror/autocomplete';
import {defaultKeymap, history, historyKeymap} from '@codemirror/commands';
import {bracketMatching, HighlightStyle, StreamLanguage, syntaxHighlighting} from '@codemirror/language';
import {setDiagnostics} from '@codemirror/lint';
import {EditorState} from '@codemirror/state';
import {EditorView, keymap} from '@codemirror/view';
import {tags} from '@lezer/highlight';

const NAMES = [['let', 'let name = ...; gives a part a name'], ['pi', '3.14159...'], ['t', 'the time, s']];

function language(known) {
    return StreamLanguage.define({
        token(stream) {
            if (stream.eatSpace()) return null;
            if (stream.match(/^[\d.]+(e[+-]?\d+)?/i)) return 'number';
            if (stream.match(/^[pv]\d*\b/)) return 'variableName';
            if (stream.match(/^let\b/)) return 'keyword';
            const word = stream.match(/^[A-Za-z_]\w*/);
            if (word) return known.has(word[0]) ? 'keyword' : 'name';
            stream.next();
            return null;
        },
    });
}
const colours = HighlightStyle.define([
    {tag: tags.number, color: 'var(--third)'}, {tag: tags.variableName, color: 'var(--accent)'}, {tag: tags.keyword, color: 'var(--second)'},
]);
const looks = EditorView.theme({
    '&': {border: '1px solid var(--line)', borderRadius: '6px', background: 'var(--paper)', font: '13px/1.4 ui-monospace, monospace', color: 'var(--ink)'},
    '&.cm-focused': {outline: '2px solid var(--accent)', outlineOffset: '1px'},
    '.cm-content': {fontFamily: 'ui-monospace, monospace', minHeight: '4.2em', caretColor: 'var(--ink)'},
    '.cm-scroller': {maxHeight: '14rem'},
    '.cm-tooltip': {background: 'var(--card)', color: 'var(--ink)', border: '1px solid var(--line)', maxWidth: '20rem'},
    '.cm-tooltip-autocomplete ul li[aria-selected]': {background: 'var(--accent)', color: 'var(--card)'},
});

/* An editor in `parent` with `text`; `functions` are {usage, help}; `changed(text)` is told what is typed. Answers {text, mark},
 * of which `mark` underlines {from, to, message}, or nothing. */
export function edit({parent, text, functions, label, id, changed}) {
    const options = [
        ...functions.map(({usage, help}) => ({label: usage.split('(')[0], detail: usage.slice(usage.indexOf('(')), info: help, type: 'function'})),
        ...NAMES.map(([name, info]) => ({label: name, info, type: 'keyword'})),
    ];
    const complete = (context) => {
        const word = context.matchBefore(/[A-Za-z_]\w*/);
        return word || context.explicit ? {from: word?.from ?? context.pos, options, validFor: /^\w*$/} : null;
    };
    const view = new EditorView({
        parent, doc: text,
        extensions: [
            history(), bracketMatching(), EditorView.lineWrapping, EditorState.allowMultipleSelections.of(false),
            language(new Set(options.map((o) => o.label))), syntaxHighlighting(colours), looks,
            autocompletion({override: [complete], icons: false}), keymap.of([...completionKeymap, ...defaultKeymap, ...historyKeymap]), // (Tab goes on to the next control)
            EditorView.contentAttributes.of({id, 'aria-label': label, spellcheck: 'false', autocapitalize: 'off'}),
            EditorView.updateListener.of((update) => update.docChanged && changed(view.state.doc.toString())),
        ],
    });
    return {
        get text() {
            return view.state.doc.toString();
        },
        set text(next) {
            view.dispatch({changes: {from: 0, to: view.state.doc.length, insert: next}});
        },
        mark(fault) {
            const {length} = view.state.doc, marks = fault ? [{from: Math.min(fault.from, length), to: Math.min(fault.to, length), message: fault.message, severity: 'error'}] : [];
            view.dispatch(setDiagnostics(view.state, marks));
        },
    };
}
