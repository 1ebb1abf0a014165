#!/bin/sh
# Renders frames of the scenes with f3d, on a virtual display where there is none.
# usage: sh examples/pictures.sh PROGRAMS DIRECTORY [SCENE]...
#     PROGRAMS  directory of the built scenes; frames go into PROGRAMS/pictures
#     DIRECTORY of SCENE.png
#     SCENE     these only
set -u
[ $# -ge 2 ] || { echo "usage: $0 PROGRAMS DIRECTORY [SCENE]..." >&2; exit 2; }
programs=$1
directory=$2
shift 2
only=$*
mkdir -p "$directory" "$programs/pictures" || exit 2
colors=0,0.85,0.37,0.30,0.2,0.95,0.65,0.30,0.4,0.98,0.88,0.55,0.6,0.60,0.80,0.65,0.8,0.35,0.62,0.75,1,0.36,0.40,0.65
failed=0

# on a display: COMMAND...
display() { if [ -n "${DISPLAY:-}" ]; then "$@"; else xvfb-run -a "$@"; fi; }

# picture SCENE EVERY FRAME ARRAY AZIMUTH ELEVATION [OPTION]...: the FRAME-th of each EVERY-th frame, coloured by `fragment`, by `material` or, outer
# surface and faces of cuts, by `surface`; OPTIONs of f3d, without any z is up
picture() {
    case " ${only:-$1} " in *" $1 "*) ;; *) return ;; esac
    echo "$1"
    rm -rf "$programs/pictures/$1"
    scene=$1 every=$2 frame=$3 array=$4 azimuth=$5 elevation=$6
    shift 6
    [ $# -gt 0 ] || set -- --up=+Z
    if [ "$array" = surface ]; then range=--range=0,1; else range=; fi
    # shellcheck disable=SC2086
    "$programs/$scene" --quiet --every "$every" --out "$programs/pictures/$scene" &&
    display f3d "$programs/pictures/$scene/frame_$frame.vtu" --output="$directory/$scene.png" --resolution 640,420 --cells --scalars="$array" $range \
        --colormap=$colors --bg-color=1,1,1 --fxaa --ssao --camera-azimuth-angle="$azimuth" --camera-elevation-angle="$elevation" --quiet "$@" && return
    echo "$scene: no picture" >&2
    failed=1
}

picture sticks 25 0005 fragment 30 25
picture thin_slab 15 0005 fragment 35 15
picture swiss_cheese 3 0022 fragment 60 20
picture accordion 10 0011 surface 20 8
picture hinged_slices 20 0009 fragment 35 15
picture slab_in_five 30 0009 fragment 35 12
picture unfolding_blocks 10 0014 surface 20 8
picture helix_plate 20 0019 surface 25 22
picture octopus 10 0011 surface 0 0 --up=+Y --camera-position=70,-20,-170 --camera-focal-point=-3,-10,-12 --camera-view-angle=30
picture bunny_groove 20 0009 surface 0 0 --up=+Y --camera-position=0.15,0.3,0.5 --camera-focal-point=0.01,0.075,0.01 --camera-view-angle=28
picture armadillo 25 0006 surface 0 0 --up=+Y --camera-position=1.6,0.9,3.6 --camera-focal-point=0.05,0.2,0.1 --camera-view-angle=24
picture noisy_plate 20 0011 surface 0 0 --up=+Z --camera-position=-2.5,-2.8,3.2 --camera-focal-point=-0.2,0,0 --camera-view-angle=40
picture overhang 12 0006 fragment 0 0 --up=+Z --camera-position=4.2,-4.6,2.4 --camera-focal-point=1.2,0.4,0.35 --camera-view-angle=21
picture surgeon 20 0010 surface 0 0 --up=+Z --camera-position=-0.25,-0.62,0.4 --camera-focal-point=0.005,-0.05,-0.035 --camera-view-angle=24
picture organ 5 0022 material 0 0 --up=+Z --camera-position=-0.25,-0.55,0.3 --camera-focal-point=-0.01,-0.04,0.0 --camera-view-angle=21
picture trainer 15 0024 material 0 0 --up=+Z --camera-position=-0.2,-0.55,0.25 --camera-focal-point=0.0,-0.05,-0.02 --camera-view-angle=26
picture pile 60 0010 fragment 30 20
picture ribbon 8 0009 surface 0 0 --up=+Z --camera-position=0.35,-1.5,-0.1 --camera-focal-point=0.03,-0.06,-0.17 --camera-view-angle=31
picture lips 15 0003 surface 20 12
picture sausage 60 0008 fragment 30 15
exit $failed
