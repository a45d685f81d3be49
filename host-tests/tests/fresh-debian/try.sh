#!/bin/bash
# The set-up on a fresh Debian: it brings everything, or says in a line what keeps it from that. And the kernel with the
# oldest Rust that it promises, which that Debian has.
#
#   sudo host-tests/tests/fresh-debian/try.sh [TRIAL ...]    all trials, or those named; exit code 1 if one fails
#
# Needs root, debootstrap, e2fsprogs, a Debian with network, rustup's stable toolchain, 6 GB and a
# quarter of an hour. Changes nothing but a folder of its own: the Debian is made there once, and
# each trial runs in a layer over it. In there rustup has no targets and reaches no server, so that
# Debian's packages must do, unpacked into target.
set -euo pipefail

here=$(cd "$(dirname "$0")" && pwd)
repository=$(cd "$here/../../.." && pwd)
folder=${TMPDIR:-/tmp}/double-pendulum-fresh-debian
base=$folder/base
toolchain=stable-x86_64-unknown-linux-gnu
trials=(twice-at-once broken-qemu without-root without-network full-disk oldest-rust)

# ---- The Debian -------------------------------------------------------------------------------------------------------

make_base() {
    rm -rf "$folder"
    mkdir -p "$folder"
    debootstrap --variant=minbase --include=gcc,libc6-dev,ca-certificates,git bookworm "$base" > "$folder/debootstrap.log"
    cp -a /etc/apt/. "$base/etc/apt/"
    cp -L /etc/resolv.conf "$base/etc/"
    cp -L /etc/ssl/certs/ca-certificates.crt "$base/etc/ssl/certs/"
    mkdir -p "$base/opt/rustup/toolchains" "$base/opt/cargo"
    cp -a "${CARGO_HOME:-$HOME/.cargo}/bin" "$base/opt/cargo/"
    cp -a "${RUSTUP_HOME:-$HOME/.rustup}/settings.toml" "$base/opt/rustup/"
    cp -a "${RUSTUP_HOME:-$HOME/.rustup}/toolchains/$toolchain" "$base/opt/rustup/toolchains/"
    forget_targets "$base/opt/rustup/toolchains/$toolchain/lib/rustlib"
    # Every trial would fetch these: they are fetched once.
    enter "$base" > "$folder/fetched.log" 2>&1 <<'END'
        set -e
        apt-get update
        apt-get install --yes --no-install-recommends --download-only rustc-web cargo-web rust-web-src qemu-system-arm
END
    touch "$folder/made"
}

# Brings what is committed into the Debian, its set-up compiled.
bring_project() {
    rm -rf "$base/opt/new"
    git clone --quiet "$repository" "$base/opt/new"
    [ ! -e "$base/opt/double-pendulum/target" ] || mv "$base/opt/double-pendulum/target" "$base/opt/new/"
    rm -rf "$base/opt/double-pendulum"
    mv "$base/opt/new" "$base/opt/double-pendulum"
    echo 'cargo build --quiet --package host-tests' | enter "$base"
}

# Makes rustup believe that no ARM target was ever added.
forget_targets() {
    rm -rf "$1"/thumb* "$1"/manifest-rust-std-thumb*
    sed -i '/thumb/d' "$1/components"
    awk 'BEGIN { RS = "\\[\\[components\\]\\]"; ORS = "" } !/thumb/ { print (NR > 1 ? "[[components]]" : "") $0 }' \
        "$1/multirust-config.toml" > "$1/multirust-config.new"
    mv "$1/multirust-config.new" "$1/multirust-config.toml"
}

# Runs the script on standard input in the root folder $1, as process 1 of its own; $2... are options of unshare.
enter() {
    local root=$1
    shift
    timeout 1500 unshare --mount --pid --fork --kill-child "$@" sh -c '
        mount -t proc proc "$1/proc"
        mount --rbind /dev "$1/dev"
        exec chroot "$1" /usr/bin/env -i HOME=/root TERM=dumb LC_ALL=C \
            PATH=/opt/cargo/bin:/usr/sbin:/usr/bin:/sbin:/bin CARGO_HOME=/opt/cargo RUSTUP_HOME=/opt/rustup \
            RUSTUP_AUTO_INSTALL=0 RUSTUP_DIST_SERVER=http://127.0.0.1:9 \
            bash -c "cd /opt/double-pendulum 2> /dev/null; . /dev/stdin"' - "$root"
}

# ---- A trial ----------------------------------------------------------------------------------------------------------

# Lays a fresh layer over the Debian, on a disk of $1 megabytes.
lay() {
    truncate --size="$1M" "$folder/disk"
    mkfs.ext4 -q -F -m 0 "$folder/disk"
    mkdir -p "$folder/layer" "$folder/root"
    mount -o loop "$folder/disk" "$folder/layer"
    mkdir -p "$folder/layer/upper" "$folder/layer/work"
    mount -t overlay overlay -o "lowerdir=$base,upperdir=$folder/layer/upper,workdir=$folder/layer/work" "$folder/root"
}

lift() {
    for mounted in root layer; do
        ! mountpoint --quiet "$folder/$mounted" || umount "$folder/$mounted"
    done
    rm -f "$folder/disk"
}

fail() {
    echo "FAILED: $*"
    sed 's/^/    /' "$folder/said"
    return 1
}

# What the set-up said must hold $1.
said() { grep --quiet -- "$1" "$folder/said" || fail "it does not say: $1"; }

# The next run ends well, the one after it finds nothing to do.
sets_up() {
    enter "$folder/root" > "$folder/said" 2>&1 <<'END' || fail "it does not set up"
        target/debug/host-tests setup --yes && target/debug/host-tests setup
END
    said "everything was ready"
}

# The command $1 ends with exit code $2; the rest are options of unshare.
ends() {
    local command=$1 expected=$2 status=0
    shift 2
    echo "$command" | enter "$folder/root" "$@" > "$folder/said" 2>&1 || status=$?
    [ "$status" = "$expected" ] || fail "exit code $status, not $expected"
}

# ---- The trials -------------------------------------------------------------------------------------------------------

twice-at-once() {
    enter "$folder/root" > "$folder/said" 2>&1 <<'END' || fail "one of the two failed"
        target/debug/host-tests setup --yes &
        target/debug/host-tests setup --yes && wait $!
END
    sets_up
}

broken-qemu() {
    sets_up && truncate --size=100000 "$folder/root/opt/double-pendulum/target/qemu/usr/bin/qemu-system-arm" || return
    ends 'target/debug/host-tests setup' 0 && said "unpacked qemu-system-arm into target/qemu" && sets_up
}

without-root() {
    chown nobody "$folder/root/opt/double-pendulum/target" # as it is for whoever made the clone
    ends 'setpriv --reuid=nobody --regid=nogroup --clear-groups target/debug/host-tests setup' 2
    # The compiler and QEMU are unpacked, which any user can do; Node.js is not.
    said "only root may install packages" && said "run cargo setup --yes, or " && sets_up
}

without-network() {
    ends 'target/debug/host-tests setup' 2 --net
    said "E: " && said "run rustup target add " && sets_up
}

full-disk() { ends 'target/debug/host-tests setup' 2 && said "No space left\|free space"; }

# Debian 12 has had several versions of these packages; its first release keeps the oldest.
oldest-rust() {
    enter "$folder/root" > "$folder/said" 2>&1 <<'END' || fail "the kernel's tests do not pass"
        set -e
        apt-get update
        apt-get install --yes --no-install-recommends {rustc-web,cargo-web,libstd-rust-web-dev}/bookworm
        promised=$(sed -n 's/^rust-version = "\(.*\)".*/\1/p' kernel/Cargo.toml)
        /usr/bin/rustc --version | grep " $promised\."
        export RUSTC=/usr/bin/rustc RUSTDOC=/usr/bin/rustdoc
        /usr/bin/cargo test --package double-pendulum-kernel --all-features --target-dir target/oldest-rust
END
}

# ---- All of it --------------------------------------------------------------------------------------------------------

trap lift EXIT
lift
[ -e "$folder/made" ] || make_base
bring_project
failures=0
for trial in "${@:-${trials[@]}}"; do
    case $trial in full-disk) lay 300 ;; *) lay 4096 ;; esac
    if "$trial"; then echo "$trial: well"; else failures=$((failures + 1)); fi
    lift
done
exit $((failures > 0))
