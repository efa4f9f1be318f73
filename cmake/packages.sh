# What the system must have, by the names of Debian 12's packages, and how it is installed. Not run by itself:
# examples/quickstart.sh and tests/run.sh read it ("." it), so that the list stands once.

# To build and to run everything.
packages_build="
gcc g++ libc6-dev cmake ninja-build pkg-config
libpopt-dev libjansson-dev libmd-dev
libpng-dev libopenexr-dev
libopenmesh-dev libtinygltf-dev
libopenvdb-dev libnanovdb-dev libtbb-dev libimath-dev libboost-dev
libglfw3-dev libepoxy-dev libcglm-dev libimgui-dev
gnuplot-nox
libegl1 libegl-mesa0 libgl1 libglx-mesa0 libgl1-mesa-dri libgles2"
# gnuplot draws neph-chart's charts. The last line is OpenGL, Mesa's software renderer included: pictures need no graphics card.

# To build and run the tests: the second compiler, the style, the test library, a screen without a screen.
packages_test="
clang libclang-rt-dev libomp-dev clang-format-14
libcmocka-dev libopenvdb-tools libnanovdb-tools locales
xvfb xauth xdotool x11-apps x11-utils imagemagick python3 parallel
bash zsh git groff-base binutils fakeroot dpkg-dev"

# Prints its arguments as one line on standard error, after the script's name, and ends the script.
die()
{
    printf '%s: %s\n' "$script" "$*" >&2
    exit 1
}

# Prints which of the packages named are not installed, separated by blanks.
packages_missing()
{
    for package in "$@"; do
        status=$(dpkg-query -W -f '${db:Status-Status}\n' "$package" 2>/dev/null) || status=
        case $status in
        installed*) ;; # once more for each foreign architecture
        *) printf '%s ' "$package" ;;
        esac
    done
}

# Says what will be done before it is done; asks where somebody is there to answer. $assume_yes is 1 where --yes was
# given. Returns where all the packages named are there.
packages_install()
{
    if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
        echo "$script: this system has no apt. Please install what these Debian 12 packages stand for:" >&2
        echo "$*" | tr '\n' ' ' | fold -s -w 100 >&2
        echo >&2
        die "then start again with --no-install (CMake 3.22 or later, a C17 and C++17 compiler with OpenMP)"
    fi
    missing=$(packages_missing "$@")
    if [ -z "$missing" ]; then
        return 0
    fi
    as_root=
    if [ "$(id -u)" -ne 0 ]; then
        as_root="sudo "
    fi
    echo "$script: some packages are missing. They will be installed from this system's mirror, by these commands:"
    echo "    ${as_root}apt-get update"
    echo "    ${as_root}env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \\"
    echo "$missing" | fold -s -w 90 | sed 's/^/        /; $!s/$/\\/'
    if [ -n "$as_root" ] && ! command -v sudo >/dev/null; then
        die "there is no sudo here (run the two commands as root, then start again)"
    fi
    if [ -t 0 ] && [ "$assume_yes" != 1 ]; then
        printf 'Go on? [y/N] '
        read -r answer || answer=
        case $answer in
        [yY] | [yY][eE][sS]) ;;
        *) die "nothing was installed (install the packages yourself, or start again and answer y)" ;;
        esac
    fi
    ${as_root}apt-get update ||
        echo "$script: the package lists could not be renewed; going on with those that are there" >&2
    # Word by word: the names hold no blanks.
    # shellcheck disable=SC2086
    ${as_root}env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $missing </dev/null ||
        die "apt-get could not install them (its message stands above; is the network there, the system Debian 12?)"
}
