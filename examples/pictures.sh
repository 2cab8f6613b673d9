#!/bin/sh
# Makes the pictures of this folder's README: each example, its heat map, and its baked materials
# under D65 and under A, side by side and at half size.
#
# Usage, in this folder: sh pictures.sh
# Needs `upglow`, and `oiiotool` (pip install OpenImageIO).
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
upglow -q build -o "$work/acescg.safetensors" > "$work/log"
# The attribute `upglow.white` of the files: the RGB of the perfect diffuser under each light, to which
# the colors are adapted.
white_D65=1,1,1
white_A=0.97941,0.61236,0.22816
for name in pool chart dusk; do
    upglow -q check "$name.exr" --heat-map "$work/heat.png" > "$work/log"
    for light in D65 A; do
        upglow -q bake "$work/acescg.safetensors" "$name.exr" -o "$work/$light.exr" \
            --as radiance --light "$light" > "$work/log"
    done
    show="--colorconvert:unpremult=0 ACEScg srgb_texture --clamp:min=0:max=1"
    oiiotool --colorconfig ocio://default \
        "$name.exr" $show \
        "$work/heat.png" --ch R,G,B \
        "$work/D65.exr" --divc "$white_D65" $show \
        "$work/A.exr" --divc "$white_A" $show \
        --mosaic:pad=16 4x1 --resize:filter=box 50% -d uint8 --dither -o "pictures/$name.png"
done
