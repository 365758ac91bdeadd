#!/bin/sh
# Writes a page for every scene, FOLDER/NAME.md: its picture, what it shows in its own words, what it is made of and with which
# fields, and what its first second comes to. `docs/make-scene-pages.sh` writes docs/scenes/; check.sh looks whether they are
# current, and takes what runs print, and who else speaks of a scene, from the pages for that (--keep): run-commands.sh runs them.
#     docs/make-scene-pages.sh [--keep] [FOLDER [SKEIN]]      (docs/scenes, build/skein)
set -u
cd "$(dirname "$0")/.." || exit 1
keep=no
if [ "${1-}" = --keep ]; then keep=yes && shift; fi
out=${1-docs/scenes} skein=${2-build/skein}
mkdir -p "$out" || exit 1

# JSON as lines "path TAB value"; lists of numbers, words and lists are one value, as they stand.
flat() {
    awk '
        function skip() { while (match(substr(text, at, 1), /[ \t\r\n]/)) at++ }
        function word(   from) { # a string with its quotes
            from = at++
            while (substr(text, at, 1) != "\"") at += substr(text, at, 1) == "\\" ? 2 : 1
            at++
            return substr(text, from, at - from)
        }
        function plain(   from, depth, c) { # a list without objects, or a number: as it stands
            from = at
            for (depth = 0; at <= length(text); at++) {
                c = substr(text, at, 1)
                if (c == "\"") { word(); at--; continue }
                if (c == "[") depth++
                if (depth == 0 && match(c, /[,}\] \n]/)) break
                if (c == "]" && --depth == 0) { at++; break }
            }
            c = substr(text, from, at - from)
            gsub(/[ \n]+/, " ", c)
            return c
        }
        function has_objects(   k, depth, c) {
            for (k = at; k <= length(text); k++) {
                c = substr(text, k, 1)
                if (c == "{") return 1
                if (c == "[") depth++
                if (c == "]" && --depth == 0) return 0
            }
        }
        function value(path,   c, k, key) {
            skip()
            c = substr(text, at, 1)
            if (c == "{") {
                at++
                for (skip(); substr(text, at, 1) != "}"; skip()) {
                    key = word()
                    gsub(/"/, "", key)
                    skip(); at++ # the colon
                    value(path == "" ? key : path "." key)
                    skip()
                    if (substr(text, at, 1) == ",") at++
                }
                at++
            } else if (c == "[" && has_objects()) {
                at++
                for (skip(); substr(text, at, 1) != "]"; skip()) {
                    value(path "." k++)
                    skip()
                    if (substr(text, at, 1) == ",") at++
                }
                at++
            } else print path "\t" (c == "\"" ? word() : plain())
        }
        { text = text $0 "\n" }
        END { at = 1; value("") }' "$1"
}

# A table of what a scene has, from those lines.
parts() {
    flat "$1" | awk -F '\t' '
        BEGIN {
            split("method bodies constraints forces colliders motions output view", lists, " ")
            split("method body constraint force collider motion output view", names, " ")
            split("methods bodies constraints forces colliders motions exporters view", anchors, " ")
            while ((getline line <"docs/methods.md") > 0) if (line ~ /^### /) has[substr(line, 5)] = 1
        }
        {
            n = split($1, part, ".")
            key = part[1]; rest = ""
            first = 2
            if (n > 1 && part[2] ~ /^[0-9]+$/) { key = key "." part[2]; first = 3 }
            for (k = first; k <= n; k++) rest = rest (k > first ? "." : "") part[k]
            if (n == 1 && part[1] == "output") { key = "output.0"; rest = "" }
            if (n == 1 && part[1] != "output") next
            if (!(key in seen)) { seen[key] = 1; order[part[1]] = order[part[1]] " " key }
            gsub(/\|/, "\\|", $2)
            if (rest == "type") { kind[key] = $2; gsub(/"/, "", kind[key]); next }
            if (rest == "name") { name[key] = $2; gsub(/"/, "", name[key]); next }
            if (length($2) > 160) $2 = substr($2, 1, 140) " ..."
            fields[key] = fields[key] (fields[key] == "" ? "" : ", ") (rest == "" ? "" : "`" rest "` ") "`" $2 "`"
        }
        END {
            print "| part | kind | what is set; all else is at its default |\n|---|---|---|"
            for (l = 1; l <= 8; l++) {
                n = split(order[lists[l]], keys, " ")
                for (k = 1; k <= n; k++) {
                    what = kind[keys[k]]
                    page = (has[what] && (l == 1 || l == 3)) ? "../methods.md#" what : "../reference.md#" anchors[l]
                    printf "| %s%s | %s | %s |\n", names[l], name[keys[k]] == "" ? "" : " \"" name[keys[k]] "\"", \
                        what == "" ? "[" names[l] "](" page ")" : "[" what "](" page ")", fields[keys[k]]
                }
            }
        }'
}

field() { flat "$1" | awk -F '\t' -v key="$2" '$1 == key { gsub(/^"|"$/, "", $2); gsub(/\\"/, "\"", $2); print $2 }'; }

page() { # SCENE NAME
    frames=$(field "$1" frames) second=60
    [ "${frames:-240}" -ge 60 ] || second=$frames
    picture=images/scenes/$2.png
    [ -s "docs/$picture" ] || picture=images/$2.png
    echo "# $2"
    echo
    echo "<!-- Made by docs/make-scene-pages.sh from scenes/$2.json: do not edit it by hand. -->"
    echo
    [ ! -s "docs/$picture" ] || printf '![%s](../%s)\n\n' "$2" "$picture"
    field "$1" description
    echo
    echo "\`skein view $2\` opens it in a window, \`skein run $2 --out $2\` writes its files and a report, and"
    echo "\`skein render $2 -o $2.mp4\` films it. Its file is [scenes/$2.json](../../scenes/$2.json): ${frames:-240} frames."
    echo
    parts "$1"
    echo
    if flat "$1" | grep -q 'meshes/fetched/'; then
        printf 'Its mesh is not in the repository: `make demo` fetches it.\n\n'
    else
        command="build/skein run $1 --frames $second"
        if [ "$second" = 60 ]; then echo "Its first 60 frames come to this on any machine (in single precision, as it is built by default), but for the times:"; else
            echo "It comes to this on any machine (in single precision, as it is built by default), but for the times:"; fi
        printf '\n```text %s\n' "$command"
        if [ $keep = yes ]; then
            awk -v fence="\`\`\`text $command" '$0 == fence { on = 1; next } /^```/ { on = 0 } on' "docs/scenes/$2.md" 2>/dev/null
        else
            "$skein" run "$1" --frames "$second" --threads 1 --no-progress 2>/dev/null | sed 's/^[0-9.e+-]* ms a step.*/.../'
        fi
        printf '```\n\n'
    fi
    if [ $keep = yes ]; then also=$(sed -n 's/^More about it: \(.*\)[.]$/\1/p' "docs/scenes/$2.md" 2>/dev/null); else also=$(cd docs && grep -l -e "scenes/$2[.]json" -e "skein [a-z]* $2\>" -- *.md | grep -v gallery.md |
        sed 's/\(.*\)[.]md/[\1](..\/&)/' | paste -sd ' ' | sed 's/ /, /g'); fi
    [ -z "$also" ] || printf 'More about it: %s.\n\n' "$also"
    echo "[All scenes](../gallery.md); [the fields of every kind](../reference.md); [how scenes are written](../scenes.md)"
}

for scene in scenes/*.json; do
    name=$(basename "$scene" .json)
    page "$scene" "$name" >"$out/$name.md.new" && mv "$out/$name.md.new" "$out/$name.md" || exit 1
done
