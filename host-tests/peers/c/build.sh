#!/bin/sh
# Builds the page's equations in C for a processor: build.sh CPU SINE COSINE ELF [OPTION OF GCC]..., ELF in
# target/peers-c.
# A sine of CMSIS-DSP's is compiled from its sources, which pip fetches from PyPI, once, by version and hash.
set -eu
cpu=$1 sine=$2 cosine=$3 elf=$4
shift 4
cd "$(dirname "$0")/../../.."
here=host-tests/peers/c
made=target/peers-c
name=cmsisdsp-1.10.3

mkdir -p "$made"
if [ "$sine" = arm_sin_f32 ]; then
    cmsis=$made/$name
    if [ ! -e "$cmsis" ]; then
        python3 -m pip download --quiet --retries 1 --no-deps --no-binary cmsisdsp \
            --requirement "$here/cmsis-dsp.txt" --dest "$made"
        unpacking=$(mktemp -d "$made/unpacking.XXXXXX")
        trap 'rm -rf "$unpacking"' EXIT
        tar -xzf "$made/$name.tar.gz" -C "$unpacking"
        mv "$unpacking/$name" "$cmsis"
    fi
    # __GNUC_PYTHON__ is the library's name for: without the headers of CMSIS-Core.
    set -- "$@" -D__GNUC_PYTHON__ "-I$cmsis/Include" "-I$cmsis/PrivateInclude" \
        "$cmsis/Source/FastMathFunctions/arm_sin_f32.c" "$cmsis/Source/FastMathFunctions/arm_cos_f32.c" \
        "$cmsis/Source/CommonTables/arm_common_tables.c"
fi
arm-none-eabi-gcc -std=gnu11 -O3 -mthumb "-mcpu=$cpu" "-DSIN=$sine" "-DCOS=$cosine" \
    "$here/measure.c" "$here/textbook.c" "$@" -ffunction-sections -fdata-sections -Wl,--gc-sections \
    -nostartfiles --specs=nosys.specs -T "$here/link.ld" -lm -o "$made/$elf"
