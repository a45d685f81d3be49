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
trap 'rm -rf "$folder.new"' EXIT
rm -rf "$folder.new"
mkdir -p "$folder.new"
cd "$folder.new"

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
program=$here/usr/lib/chromium/$(basename "$0") # its script in usr/bin runs the installed one
[ -x "$program" ] || program=$here/usr/bin/$(basename "$0")
exec "$program" "$@"
END
    chmod 755 "$program"
    "./$program" --version
done

rm -rf "$folder"
mv "$folder.new" "$folder"
