# For tests of neph-view's window: a screen of its own (Xvfb), and what a person does and sees. Sourced with $bin, $source
# and $test, the test's name, set; leaves the shell in a folder of its own. KEEP=folder keeps the
# pictures there, in a folder of the test's name.
temporary=$(mktemp -d)
screen=
viewer=
finish()
{
    status=$?
    trap - EXIT
    [ -z "$viewer" ] || kill "$viewer" 2>/dev/null || true
    [ -z "$screen" ] || kill "$screen" 2>/dev/null || true
    [ -z "${KEEP:-}" ] || { rm -f ?.part.png && mkdir -p "$KEEP/$test" && cp "$temporary"/*.png "$KEEP/$test"; } 2>/dev/null || true
    rm -r "$temporary"
    exit "$status"
}
trap finish EXIT
cd "$temporary"

fail()
{
    echo "$test: $*" >&2
    exit 1
}

for tool in Xvfb xdotool xprop import compare convert identify; do
    command -v $tool >/dev/null || fail "$tool is missing (tests/run.sh installs what the tests need)"
done

# until_true SECONDS COMMAND...: tries it again and again
until_true()
{
    wait_end=$(($(date +%s) + $1))
    shift
    while :; do
        ! "$@" || return 0
        [ -z "$viewer" ] || kill -0 "$viewer" 2>/dev/null || fail "the viewer ended: $(cat viewer.log)"
        [ "$(date +%s)" -lt "$wait_end" ] || return 1
        sleep 0.1
    done
}

unset WAYLAND_DISPLAY
# Another server that ends at the same moment may take this one's socket with it; so there are three tries.
answers() { xdotool getdisplaygeometry >/dev/null 2>&1; }
for _ in 1 2 3; do
    : >display
    # shellcheck disable=SC2086
    Xvfb -displayfd 3 -screen 0 800x600x24 ${screen_options:-} -nolisten tcp -noreset 3>display 2>xvfb.log &
    screen=$!
    until_true 20 test -s display || fail "Xvfb did not start: $(cat xvfb.log)"
    DISPLAY=:$(cat display)
    export DISPLAY
    ! until_true 10 answers || break
    kill "$screen" 2>/dev/null || true
    wait "$screen" || true
done
answers || fail "no screen answers: $(cat xvfb.log)"


# open TITLE ARGUMENT...: starts the viewer, and waits for its window, whose title has that part
open()
{
    window_title=$1
    shift
    "$bin/neph-view" "$@" 2>viewer.log &
    viewer=$!
    until_true 60 find_window || fail "no window came up: $(cat viewer.log)"
}
find_window()
{
    window=$(xdotool search --onlyvisible --name "$window_title" 2>/dev/null | head -n 1) || true
    [ -n "$window" ]
}
# quit: by Esc; the viewer must end well
quit()
{
    # The window is gone before the key is let go, which xdotool takes amiss; a key that stays down would close the next one.
    # Where light is still being made, the first Escape breaks that off, and another one ends the viewer.
    for _ in 1 2 3 4 5 6 7 8; do
        key Escape 2>/dev/null || true
        for _ in 1 2 3 4 5 6; do
            sleep 0.5
            case $(ps -o stat= -p "$viewer") in
            '' | Z*) break 2 ;;
            esac
        done
        xdotool keyup Escape 2>/dev/null || true
    done
    # With its last window a screen begins anew, and answers nobody for a moment.
    xdotool keyup Escape 2>/dev/null || { sleep 1; xdotool keyup Escape; }
    status=0
    wait "$viewer" || status=$?
    viewer=
    [ "$status" = 0 ] || fail "Esc ended the viewer with $status: $(cat viewer.log)"
}
rests() { ! xdotool getwindowname "$window" | grep -q working; }
# shot NAME: a screenshot of a picture that rests
shot()
{
    rest_end=$(($(date +%s) + 90)) # a loop of its own: until_true calls this
    until rests; do
        kill -0 "$viewer" 2>/dev/null || fail "the viewer ended: $(cat viewer.log)"
        [ "$(date +%s)" -lt "$rest_end" ] || fail "the picture \"$1\" did not come to rest"
        sleep 0.1
    done
    timeout 20 import -window "$window" "$1.png" || fail "no screenshot \"$1\" could be taken: $(cat viewer.log)"
}
# distance PART A B: root mean square difference within a part of the window, of 1
distance()
{
    convert "$2.png" -crop "$1" +repage a.part.png
    convert "$3.png" -crop "$1" +repage b.part.png
    compare -metric RMSE a.part.png b.part.png null: 2>&1 | sed 's/.*(\(.*\)).*/\1/'
}
is_like() { shot "$2" && awk "BEGIN { exit !($(distance "$1" "$2" "$3") < 0.012) }"; }
is_unlike() { shot "$2" && awk "BEGIN { exit !($(distance "$1" "$2" "$3") > ${4:-0.03}) }"; }
# like PART NEW OLD, unlike PART NEW OLD [LEAST]: as the window is now; it has some seconds to become so
like() { until_true 40 is_like "$@" || fail "the ${1#*+} part of $2 should look like $3: $(distance "$1" "$2" "$3")"; }
unlike() { until_true 40 is_unlike "$@" || fail "$2 should not look like $3: $(distance "$1" "$2" "$3")"; }
key() { xdotool key --window "$window" "$@"; }
at() { xdotool mousemove --window "$window" "$@"; }
# press X Y: a click, no faster than a hand, once the mouse has been seen there
press()
{
    at "$1" "$2"
    sleep 0.3
    xdotool mousedown 1
    sleep 0.2
    xdotool mouseup 1
    sleep 0.3
}
# fold Y...: clicks on the headings of the panel's sections that are open, from the first on
fold()
{
    for y; do
        press 60 "$y"
    done
}
# drag FROM-X FROM-Y TO-X TO-Y: no faster than a hand
drag()
{
    at "$1" "$2" mousedown 1
    sleep 0.3
    at $((($1 + $3) / 2)) $((($2 + $4) / 2))
    sleep 0.2
    at "$3" "$4"
    sleep 0.3
    xdotool mouseup 1
}
