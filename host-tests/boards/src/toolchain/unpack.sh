#!/bin/sh
# Unpacks Debian packages, with all that they need and that is not installed, into the folder $1 of
# this project, and makes their programs runnable there. $2 is the list of the programs, $3 that of
# the packages.
#
# Installs nothing on the system and needs no root. Where the system's lists of packages are missing
# or name packages that are gone, it fetches lists of its own.
set -eu
folder=$1
programs=$2
packages=$3
mkdir -p "$(dirname "$folder")"
new=$(mktemp -d "$folder.XXXXXX") # two set-ups at the same time do not meet
trap 'rm -rf "$new"' EXIT
cd "$new"

# Fetches the packages; $@ are options of apt-get.
fetch() {
    # Each line: 'address' name_version_architecture.deb size checksum
    # shellcheck disable=SC2086 # a list of words
    apt-get "$@" install --yes --quiet --no-install-recommends --reinstall --print-uris $packages > uris || return
    names=$(sed -n "s/^'[^']*' \([^_ ]*\)_.*/\1/p" uris)
    # shellcheck disable=SC2086 # a list of words
    apt-get "$@" download --quiet $names
}

set -- -o Acquire::http::Timeout=30 -o Acquire::Retries=1
if ! fetch "$@"; then
    rm -f -- *.deb
    mkdir -p lists/partial cache/archives/partial
    set -- "$@" -o "Dir::State::Lists=$PWD/lists" -o "Dir::Cache=$PWD/cache"
    apt-get "$@" update --quiet
    fetch "$@"
fi
for package in *.deb; do
    dpkg-deb --extract "$package" .
done
rm -rf -- uris *.deb lists cache

# Debian's Node.js has the folder of its modules compiled in. The programs below open that folder as file 9.
for library in usr/lib/*/libnode.so.*; do
    [ ! -f "$library" ] || sed -i 's|/usr/share/nodejs/|/proc/self/fd/9///|g' "$library"
done

# A program finds its data beside itself, but not its libraries.
for program in $programs; do
    cat > "$program" <<'END'
#!/bin/sh
here=$(dirname "$(readlink -f "$0")")
for folder in "$here"/usr/lib/*-linux-gnu* "$here"/usr/lib/*-linux-gnu*/pulseaudio \
    "$here"/lib/*-linux-gnu* "$here"/usr/lib; do
    LD_LIBRARY_PATH=$folder${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
done
export LD_LIBRARY_PATH
if [ -e "$here/usr/share/nodejs" ]; then
    exec 9< "$here/usr/share/nodejs"
    NODE_PATH=$here/usr/share/nodejs PATH=$here:$PATH
    export NODE_PATH PATH
fi
program=$here/usr/lib/chromium/$(basename "$0") # its script in usr/bin runs the installed one
[ -x "$program" ] || program=$here/usr/bin/$(basename "$0")
exec "$program" "$@"
END
    chmod 755 "$program"
    "./$program" --version
done

rm -rf "$folder"
chmod 755 "$new"
mv "$new" "$folder"
