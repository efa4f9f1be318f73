#!/bin/sh
# A program in the documents' commands (tests/docs.py): run under its own name, with what makes it quick set behind what
# the document says, so that every word of the document is still read. A failure is written to $DOCS_FAILED, with the
# document's line, whatever the shell makes of it in a pipe.
program=$(basename "$0")
given=" $* "
say="$program $*"
case $program in
neph-render)
    case $given in
    *" --compare "*) ;;
    *) set -- "$@" --size 16x9 --spp 1 ;;
    esac
    ;;
neph-view)
    set -- "$@" --size 16x9
    case $given in
    *" --error "*) ;; # chooses grid and samples itself
    *) set -- "$@" --light-grid 8 ;;
    esac
    case $given in
    *" --error "*) ;;
    *" --bench "*) set -- "$@" --bench 2 ;;
    *" --frames "*..*) set -- "$@" --samples 1 --frames 0..1 ;;
    *" --headless "*) set -- "$@" --samples 1 ;;
    *) set -- "$@" --samples 1 --headless -o window.png ;; # there is no display
    esac
    ;;
neph-vdb)
    case $given in
    *.vdb" "*"-o "*.neph" "* | *.raw" "*"-o "*.neph" "*) set -- "$@" --primitives 2 --cells 16 ;;
    *" --error "* | *" --voxel-size "*) ;;
    *) set -- "$@" --resolution 16 ;;
    esac
    ;;
neph-mesh)
    case $given in
    *" --fill "*) set -- "$@" --fill 4 --voxels 24 ;;
    esac
    ;;
blender)
    case $given in
    *" -b "*) ;;
    *) set -- -b "$@" ;; # there is no display
    esac
    case $given in
    *import_vdb.py*) set -- "$@" --size 16x9 --samples 1 ;;
    esac
    PATH=$DOCS_PROGRAMS:${PATH#*:}
    DOCS_PROGRAMS=$(dirname "$(command -v blender)")
    set -- --python-exit-code 1 "$@"
    ;;
esac
errors=$(mktemp)
"$DOCS_PROGRAMS/$program" "$@" 2>"$errors"
code=$?
if [ "$code" -ne 0 ]; then
    echo "$DOCS_LINE: $say: exit $code: $(grep -v '^$' "$errors" | tail -n 1)" >>"$DOCS_FAILED"
fi
rm -f "$errors"
exit "$code"
