#!/bin/sh
# Installs what a group of targets needs and the system lacks, by the system's own package manager. Prints what it does.
# usage: sh tests/install.sh GROUP...
#     check   Check and pkg-config, for the unit tests
#     cxx     a C++ compiler, for the compile tests
#     bench   SuiteSparse, the direct solver in the benches
#     charts  gnuplot, for charts
#     open    CGAL and npm, for other kernels in the benches
#     wasm    clang with its parts for WebAssembly, and node, which runs it
#     web     the same of clang 16 or later, for the page
#     musl    a C compiler with musl, for the bench of the page
#     platforms  cross compilers for Windows, ARM and S/390, and emulators that run their programs
#     format  clang-format 14
#     page    Chromium and node, for the page that the demo makes
#     animation  the same, and img2webp, for the README's animated picture
#     bindings  python3 with numpy, and mono's C# compiler, for the tests of bindings
#     cmake   CMake, for the test of the installed package
#     pictures  f3d, and a virtual display if there is no other, for pictures of scenes
set -u

# has PROGRAM...: are all installed?
has() {
    for program in "$@"; do command -v "$program" >/dev/null 2>&1 || return 1; done
}

# Is there a header of this name? Only the compiler knows where it searches.
header() {
    # shellcheck disable=SC2046
    printf '#include <%s>\n' "$1" | "${CC:-cc}" $(pkg-config --cflags CHOLMOD 2>/dev/null) -E - >/dev/null 2>&1
}

# Does clang link a program for WebAssembly?
links_wasm() {
    object=$(mktemp) || return 1
    echo 'int main(void) { return 0; }' | clang --target=wasm32-wasi --sysroot=/usr -x c - -o "$object" -lm >/dev/null 2>&1
    code=$?
    rm -f "$object"
    return $code
}

# Does a clang of 16 or later?
links_web() {
    for version in 21 20 19 18 17 16; do
        has "clang-$version" || continue
        object=$(mktemp) || return 1
        echo 'int main(void) { return 0; }' | "clang-$version" --target=wasm32-wasi --sysroot=/usr -x c - -o "$object" -lm >/dev/null 2>&1
        code=$?
        rm -f "$object"
        [ $code -ne 0 ] || return 0
    done
    return 1
}

# The version of its parts is clang's own.
wasm_packages() {
    has clang || echo clang
    has node || echo nodejs
    version=$(clang -dumpversion 2>/dev/null | cut -d . -f 1)
    echo lld wasi-libc "libclang-rt-${version:+$version-}dev-wasm32"
}

has_browser() { has chromium || has chromium-browser || has google-chrome || [ -d /Applications/Chromium.app ]; }

have() {
    case $1 in
    check) has pkg-config && pkg-config --exists check ;;
    cxx) has g++ || has clang++ || has c++ ;;
    bench) header cholmod.h || header suitesparse/cholmod.h ;;
    charts) has gnuplot ;;
    open) has node npm && printf '#include <CGAL/version.h>\n' | "${CXX:-c++}" -x c++ -E - >/dev/null 2>&1 ;;
    wasm) has node && links_wasm ;;
    web) has node && links_web ;;
    musl) has musl-gcc ;;
    platforms) has x86_64-w64-mingw32-gcc i686-w64-mingw32-gcc wine aarch64-linux-gnu-gcc arm-linux-gnueabihf-gcc s390x-linux-gnu-gcc \
        qemu-aarch64-static qemu-arm-static qemu-s390x-static ;;
    format) has clang-format ;;
    page) has node && has_browser ;;
    animation) has node && has_browser && has img2webp ;;
    bindings) has mcs && { python3 -c 'import numpy' || /usr/bin/python3 -c 'import numpy'; } 2>/dev/null ;;
    cmake) has cmake ;;
    pictures) has f3d && { [ -n "${DISPLAY:-}" ] || has xvfb-run; } ;;
    *) echo "$0: no group '$1'" >&2; exit 2 ;;
    esac
}

# packages GROUP MANAGER
packages() {
    case $1:$2 in
    check:apt-get) echo check pkg-config ;;
    check:dnf) echo check-devel pkgconf-pkg-config ;;
    check:pacman) echo check pkgconf ;;
    check:brew) echo check pkg-config ;;
    cxx:apt-get) echo g++ ;;
    cxx:dnf) echo gcc-c++ ;;
    cxx:*) echo gcc ;;
    bench:apt-get) echo libsuitesparse-dev libopenblas0-serial ;; # the BLAS that the first brings is a reference, and slow
    bench:dnf) echo suitesparse-devel ;;
    bench:pacman) echo suitesparse ;;
    bench:brew) echo suite-sparse pkg-config ;;
    charts:apt-get) echo gnuplot-nox ;;
    open:apt-get) echo g++ libcgal-dev nodejs npm ;;
    open:dnf) echo gcc-c++ CGAL-devel nodejs npm ;;
    open:pacman) echo gcc cgal nodejs npm ;;
    open:brew) echo cgal node ;;
    charts:*) echo gnuplot ;;
    wasm:apt-get) wasm_packages ;;
    musl:apt-get) echo musl-tools ;;
    musl:dnf) echo musl-gcc ;;
    musl:*) echo musl ;;
    web:apt-get) echo nodejs clang-16 lld-16 wasi-libc libclang-rt-16-dev-wasm32 ;;
    platforms:apt-get) echo gcc-mingw-w64 wine wine64 qemu-user-static gcc-aarch64-linux-gnu gcc-arm-linux-gnueabihf gcc-s390x-linux-gnu ;;
    format:apt-get|format:brew) echo clang-format ;;
    format:*) echo clang-tools-extra ;;
    page:apt-get|page:dnf|page:pacman) echo chromium nodejs ;;
    page:brew) echo chromium node ;;
    animation:apt-get) echo chromium nodejs webp ;;
    animation:dnf) echo chromium nodejs libwebp-tools ;;
    animation:pacman) echo chromium nodejs libwebp ;;
    animation:brew) echo chromium node webp ;;
    bindings:apt-get) echo python3-numpy mono-mcs ;;
    bindings:dnf) echo python3-numpy mono-core ;;
    bindings:pacman) echo python-numpy mono ;;
    bindings:brew) echo numpy mono ;;
    cmake:*) echo cmake ;;
    pictures:apt-get) echo f3d xvfb xauth ;;
    pictures:dnf) echo f3d xorg-x11-server-Xvfb ;;
    pictures:pacman) echo f3d xorg-server-xvfb ;;
    pictures:brew) echo f3d ;;
    esac
}

install() {
    manager=$1
    shift
    case $manager in
    apt-get) $root env DEBIAN_FRONTEND=noninteractive sh -c \
        'apt-get install -y -q "$@" || { apt-get update -q && apt-get install -y -q "$@"; }' install "$@" ;;
    dnf) $root dnf install -y "$@" ;;
    pacman) $root pacman -Sy --needed --noconfirm "$@" ;;
    brew) brew install "$@" ;;
    esac
}

[ $# -gt 0 ] || { echo "usage: $0 check|cxx|bench|charts|wasm|platforms|format|cmake|page|animation|pictures..." >&2; exit 2; }
missing=
for group in "$@"; do have "$group" || missing="$missing $group"; done
[ -n "$missing" ] || exit 0

manager=
for candidate in apt-get dnf pacman brew; do
    if has $candidate; then manager=$candidate; break; fi
done
if [ -z "$manager" ]; then
    echo "$0: missing:$missing, and none of apt-get, dnf, pacman, brew is here to install it: please install it by hand" >&2
    exit 1
fi
root=
if [ $manager != brew ] && [ "$(id -u)" -ne 0 ]; then
    if has sudo; then root=sudo; else
        echo "$0: missing:$missing; to install it, run as root: sh $0$missing" >&2
        exit 1
    fi
fi
log=$(mktemp) || exit 1
trap 'rm -f "$log"' EXIT
for group in $missing; do
    echo "installing $(packages "$group" $manager) with $root${root:+ }$manager"
    # shellcheck disable=SC2046
    install $manager $(packages "$group" $manager) >"$log" 2>&1
    if ! have "$group"; then
        tail -n 20 "$log" >&2
        echo "$0: '$group' could not be installed (above: what $manager said); please install $(packages "$group" $manager) by hand" >&2
        exit 1
    fi
done
