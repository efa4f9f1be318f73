# Manual pages and completion of every program: the page is sound roff and has all that --help has, with examples and
# exit codes; bash and zsh complete every option of --help and every choice. $1: programs.
set -eu
bin=$(cd "$1" && pwd)
temporary=$(mktemp -d)
trap 'rm -r "$temporary"' EXIT
cd "$temporary"

mistakes=0
fail()
{
    echo "cli_manual: $*" >&2
    mistakes=$((mistakes + 1))
}

for tool in groff bash zsh; do
    command -v $tool >/dev/null || {
        echo "cli_manual: $tool is missing (tests/run.sh installs what the tests need)" >&2
        exit 1
    }
done

# words: a text as one word a line, so that line breaks and indentation do not count.
words()
{
    tr -s ' \n' '\n\n' | sed '/^$/d'
}

# in_page SECTION: the text of a section of the page.
in_page()
{
    awk -v section="$1" '/^[A-Z]/ { inside = $0 == section; next } inside' page
}

check_manual()
{
    "$bin/$1" --generate man -o page.1
    groff -man -K utf8 -T utf8 -ww -rLL=200n -P-c -P-b -P-u page.1 >page 2>warnings || fail "$1: groff refuses its page"
    [ ! -s warnings ] || fail "$1: groff warns of its page: $(head -n 3 warnings)"
    for section in NAME SYNOPSIS DESCRIPTION OPTIONS EXAMPLES "EXIT STATUS"; do
        [ -n "$(in_page "$section")" ] || fail "$1: its page has no $section (a program's examples are in its cli_program)"
    done
    in_page EXAMPLES | grep -q "$1" || fail "$1: no example of its page calls it"
    for code in 0 1 2; do
        in_page "EXIT STATUS" | grep -q "^ *$code " || fail "$1: its page does not say what exit code $code means"
    done
    # The options of --help, with their texts, are those of the page, in the same order.
    awk '/^Examples:$/ { exit } options && !/^[A-Z].*:$/ { print } /^[A-Z].*:$/ { options = 1 }' help | words >a
    in_page OPTIONS | sed '/^   [^ ]/d' | words >b
    cmp -s a b || fail "$1: --help and its page list other options: $(diff a b | head -n 5)"
}

# complete_bash PROGRAM WORD...: what bash offers for the last word.
complete_bash()
{
    bash -c 'set -eu; . ./bash; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=()
        _${1//-/_}; printf "%s\n" "${COMPREPLY[@]}"' complete "$@"
}

check_bash()
{
    "$bin/$1" --generate bash -o bash
    bash -n bash || fail "$1: bash does not read its completion"
    complete_bash "$1" -- | sort >a
    diff options a >difference || fail "$1: bash completes other options than --help lists: $(cat difference)"
    while read -r option choices; do
        for words in "$option" "$option ="; do
            # shellcheck disable=SC2086
            complete_bash "$1" $words "" | tr '\n' '|' >a
            [ "$(cat a)" = "$choices|" ] || fail "$1 $words: bash offers $(cat a), not $choices"
        done
    done <choices
    touch "a file.neph"
    complete_bash "$1" -o "a f" | grep -qx "a file.neph" || fail "$1 -o: bash offers no files"
    [ -z "$(complete_bash "$1" --seed "")" ] || fail "$1 --seed: bash offers what is no number"
}

# _arguments is zsh's own; here it prints what it would be given.
check_zsh()
{
    "$bin/$1" --generate zsh -o zsh
    [ "$(head -n 1 zsh)" = "#compdef $1" ] || fail "$1: its zsh completion does not begin by #compdef"
    zsh -f -c '_arguments() { print -rl -- "$@" }; . ./zsh' >specs || fail "$1: zsh does not read its completion"
    grep -oE -e '^(\(.*\))?--[a-z0-9-]+' specs | grep -oE -e '--[a-z0-9-]+$' | sort -u >a
    grep -e '^--' options | diff - a >difference ||
        fail "$1: zsh completes other options than --help lists: $(cat difference)"
    while read -r option choices; do
        grep -F -e "$option=[" specs | grep -qF ":($(echo "$choices" | tr '|' ' '))" ||
            fail "$1 $option: zsh does not offer $choices"
    done <choices
}

count=0
for path in "$bin"/neph-*; do
    program=$(basename "$path")
    "$path" --help >help
    grep -E '^  (-., )?--' help | grep -oE -e '^  (-., )?--[a-z0-9-]+' >names
    grep -oE -e '--[a-z0-9-]+' names | sort -u >options
    grep -oE -e '--[a-z0-9-]+ [a-z0-9-]+(\|[a-z0-9-]+)+' help | sort -u >choices
    check_manual "$program"
    check_bash "$program"
    check_zsh "$program"
    count=$((count + 1))
done
[ "$count" -eq 11 ] || fail "$count programs in $bin, not 11"
[ "$mistakes" -eq 0 ] || exit 1
echo "$count programs"
