# Every key that the viewer's window obeys stands in its help (H) and in docs/viewer.md. $1: programs, $2: source folder.
set -eu
source=$2

fail()
{
    echo "cli_view_keys: $*" >&2
    exit 1
}

# What the help calls a key of GLFW; nothing for those that only go with others.
shown()
{
    case $1 in
    EQUAL | KP_ADD) echo '+' ;;
    MINUS | KP_SUBTRACT) echo '-' ;;
    ESCAPE) echo Esc ;;
    HOME) echo Home ;;
    TAB) echo Tab ;;
    SPACE) echo Space ;;
    LEFT_SHIFT | RIGHT_SHIFT | LEFT_CONTROL | RIGHT_CONTROL) ;;
    *) echo "$1" ;;
    esac
}

help=$(sed -n '/rows\[\]\[2\]/,/};/p' "$source/viewer/panel_overlay.cpp" | sed -n 's/^ *{"\([^"]*\)".*/\1/p')
table=$(sed -n 's/^| \([^|]*\) |.*/\1/p' "$source/docs/viewer.md")
[ "$(echo "$help" | wc -l)" -gt 15 ] || fail "the help's rows are not found in viewer/panel_overlay.cpp"
keys=$(grep -o 'GLFW_KEY_[A-Z0-9_]*' "$source/viewer/window_input.c" | sed 's/GLFW_KEY_//' | sort -u)
[ "$(echo "$keys" | wc -l)" -gt 20 ] || fail "the keys are not found in viewer/window_input.c"
# has TEXT KEY: whether the key stands in it as a word, alone or behind Ctrl+ and Shift+
has() { echo "$1" | sed 's/+Shift//g; s/Ctrl+//g' | tr ' ,;' '\n\n\n' | grep -qxF -e "$2"; }
for key in $keys; do
    word=$(shown "$key")
    [ -n "$word" ] || continue
    has "$help" "$word" || fail "$key ($word) is not in the help"
    has "$table" "$word" || fail "$key ($word) is not in docs/viewer.md"
done
