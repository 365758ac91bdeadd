#!/bin/sh
# How the window keeps up without a graphics card: bench/window.sh [SKEIN [SECONDS]]
# Plays each scene at 1280 x 720 on a virtual screen (Xvfb) under Mesa's llvmpipe, and reads the window's own events: the
# share of real time, pictures a second, what a step and a picture take, and how long the panels were away at most while
# the pointer goes over them. The first three seconds do not count: the driver makes its shaders then. Bars: see README.md.
# Status 1 if one is missed, 2 if it cannot be measured. Leave the machine alone while it runs.
set -u
cd "$(dirname "$0")/.." || exit 2
skein=${1:-build/skein} seconds=${2:-12}
for program in Xvfb xdotool; do
    command -v $program >/dev/null || { echo "window.sh: $program is missing: 'tools/setup test' installs it" >&2; exit 2; }
done
folder=$(mktemp -d) screen='' missed=0
trap '[ -z "$screen" ] || kill "$screen" 2>/dev/null; rm -rf "$folder"' EXIT
mkfifo "$folder/number"
Xvfb -displayfd 3 -screen 0 1280x720x24 -nolisten tcp 3>"$folder/number" >/dev/null 2>&1 &
screen=$!
read -r number <"$folder/number" || exit 2
DISPLAY=:$number
LIBGL_ALWAYS_SOFTWARE=1
export DISPLAY LIBGL_ALWAYS_SOFTWARE

# measure NAME LEAST_SPEED LEAST_PICTURES ARGUMENT...: one line of the table
measure() {
    name=$1 speed=$2 pictures=$3
    shift 3
    : >"$folder/events"
    timeout -s INT $((seconds + 3)) "$skein" view "$@" --size 1280x720 --unfocused play --events "$folder/events" \
        >"$folder/words" 2>&1 &
    window=$!
    end=$(($(date +%s) + seconds + 2)) x=20
    while kill -0 $window 2>/dev/null && [ "$(date +%s)" -lt $end ]; do
        xdotool mousemove $((x = (x + 37) % 200)) $((100 + x * 2)) sleep 0.4
    done
    wait $window
    awk -v name="$name" -v least_speed="$speed" -v least_pictures="$pictures" '
        function number(key,  at) { at = index($0, " " key "="); return substr($0, at + length(key) + 2) + 0 }
        /^pace / && ++seen > 3 {
            count++; speed += number("speed"); rate += number("pictures"); step += number("step_ms"); draw += number("draw_ms")
        }
        /^late / && seen >= 3 && $2 > longest { longest = $2 }
        END {
            if (!count) { print name ": nothing was measured"; exit 2 }
            bad = speed / count < least_speed || rate / count < least_pictures || longest > 50
            panels = longest ? sprintf("%.0f ms", longest) : "under 25 ms"
            printf "%-14s %5.1f %%  %5.1f pictures/s  step %6.3f ms  picture %5.1f ms  panels %s%s\n", name,
                100 * speed / count, rate / count, step / count, draw / count, panels, bad ? "  MISSED" : ""
            exit bad
        }' "$folder/events" || missed=1
}

for scene in drape flag cube_bowl birds; do measure $scene 0.97 15 scenes/$scene.json; done
measure 'cloth 512^2' 0 0 scenes/drape.json --set 'bodies.0.grid=[512,512]'
exit $missed
