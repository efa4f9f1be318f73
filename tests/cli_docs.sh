# The documents' commands are run as they stand, and what the pages point at is there: see docs.py beside this file.
# $1: programs, $2: source folder; behind them --blender, to run Blender's commands too, and pages, if not all.
set -eu
exec python3 "$2/tests/docs.py" "$@"
