#!/bin/sh
# Unpacks Debian's package $2 of QEMU, with all that it needs and that is not installed, into the folder $1 of this project, and
# makes its program $3 runnable there.
# Installs nothing: for systems where installing it would cost the user another package (a newer qemu-utils, say).
set -eu
folder=$1
package=$2
program=$3
trap 'rm -rf "$folder.new"' EXIT
rm -rf "$folder.new"
mkdir -p "$folder.new"
cd "$folder.new"

# Each line: 'address' name_version_architecture.deb size checksum
apt-get install --yes --quiet --no-install-recommends --print-uris "$package" > packages
names=$(sed -n "s/^'[^']*' \([^_ ]*\)_.*/\1/p" packages)
# shellcheck disable=SC2086 # a list of words
apt-get download --quiet -o Acquire::http::Timeout=30 -o Acquire::Retries=1 $names
for package in *.deb; do
    dpkg-deb --extract "$package" .
done
rm -- packages *.deb

# QEMU finds its data beside itself, but not its libraries.
cat > "$program" <<'END'
#!/bin/sh
here=$(dirname "$(readlink -f "$0")")
for folder in "$here"/usr/lib/*-linux-gnu* "$here"/lib/*-linux-gnu*; do
    LD_LIBRARY_PATH=$folder${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
done
export LD_LIBRARY_PATH
exec "$here/usr/bin/$(basename "$0")" "$@"
END
chmod 755 "$program"
"./$program" --version

rm -rf "$folder"
mv "$folder.new" "$folder"
